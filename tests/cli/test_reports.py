"""What ``inspect`` and ``solve`` print holds words of strangers: none of them commands the terminal."""

from dataclasses import replace

from studio.capture.jobs import Offset, SolveReport
from studio.cli.reports import inspection_text, solve_text
from studio.core.body import PRESETS
from studio.core.sample import SensorId
from studio.core.take import Alignment, Mark
from studio.storage.take_reader import read_take
from studio.storage.take_store import write_take
from tests.core.worn_sensors import worn_take

COLOUR, BACKWARDS = "\x1b[31mred\x07", "\u202eesrever"


def test_names_marks_and_sources_of_strangers_stay_in_their_line(tmp_path):
    take, _ = worn_take(PRESETS["lower"], 12.0)
    _, report = read_take(write_take(take, tmp_path))
    info = replace(take.streams[0].info, sensor=SensorId(f"file:{COLOUR}"))
    forged = replace(
        take,
        name=COLOUR + BACKWARDS,
        person=BACKWARDS,
        source=f"csv{COLOUR}",
        streams=(replace(take.streams[0], info=info), *take.streams[1:]),
        marks=(*take.marks, Mark(3.0, "marker", f"{COLOUR}\nforged line"), Mark(4.0, f"kind{BACKWARDS}", "")),
    )

    printed = inspection_text(forged, report, None)

    assert all(line.isprintable() for line in printed.splitlines())
    assert "3.00 s  marker [31mred forged line\n" in printed
    assert printed.startswith("[31mredesrever  esrever  12.00 s")


def test_the_name_of_a_sensor_is_harmless_in_the_report_of_a_solution():
    offsets = {SensorId(f"file:{COLOUR}"): Offset("vqf", (0.0, 0.0, 0.0), 0.0)}

    printed = solve_text(SolveReport("key", 1, 0.02, "offline", "vqf", Alignment("n", 0.0, 1.0, {}), (), offsets))

    assert all(line.isprintable() for line in printed.splitlines())
    assert "file:[31mred" in printed
