"""Tables in text files: every way programs write them gives the same numbers, and bad rows are counted."""

import codecs

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from studio.core.errors import RecordingUnreadable
from studio.importers.table import open_table

PLAIN = "t,gx,gy\n0.00,1.5,-2\n0.01,2.5,-3\n0.02,3.5,-4\n"
NUMBERS = np.array([[0, 1.5, -2], [0.01, 2.5, -3], [0.02, 3.5, -4]])


@pytest.fixture
def table(tmp_path):
    def write_and_open(content):
        path = tmp_path / "table.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return open_table(path)

    return write_and_open


@pytest.mark.parametrize(
    "written",
    [
        PLAIN,
        "\ufeff" + PLAIN,
        codecs.BOM_UTF16_LE + PLAIN.encode("utf-16-le"),
        codecs.BOM_UTF16_BE + PLAIN.encode("utf-16-be"),
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("\n", "\r"),
        PLAIN.replace(",", ";"),
        PLAIN.replace(",", "\t"),
        PLAIN.replace(",", " "),
        PLAIN.replace(",", "   "),
        PLAIN.replace(",", " , "),
        PLAIN.replace(",", ";").replace(".", ","),
        PLAIN.replace(",", "\t").replace(".", ","),
        PLAIN.replace("t,gx,gy", '"t","gx","gy"'),
        '"t","gx","gy"\n' + "".join(f'"{a}","{b}","{c}"\n' for a, b, c in NUMBERS),
        '"t";"gx";"gy"\n' + "".join(f'"{a}";"{b}";"{c}"\n'.replace(".", ",") for a, b, c in NUMBERS),
        "# made by a logger, 3 channels\n\nRate: 100 Hz\n" + PLAIN,
        "// x\nsep=,\n" + PLAIN,
        PLAIN.replace("gy\n", "gy\ns,rad/s,rad/s\n"),
        "# " + PLAIN,
        PLAIN.replace("\n", ",\n"),
        PLAIN.replace("-2\n", "-2,\n").replace("-3\n", "-3,\n").replace("-4\n", "-4,\n"),
        PLAIN + "\n\n",
        PLAIN.replace("0.02,", "\n0.02,"),
        PLAIN.rstrip("\n"),
        PLAIN.replace("0.01", "1e-2").replace("2.5", "+2.50"),
    ],
)
def test_ways_of_writing_a_table_make_no_difference(table, written):
    opened = table(written)
    columns = [opened.column(name) for name in ("t", "gx", "gy")]

    assert columns == [0, 1, 2]
    rows = opened.read(columns)
    assert np.array_equal(rows.values, NUMBERS)
    assert rows.dropped == 0


def test_a_table_without_header_has_positions_only(table):
    opened = table(PLAIN[PLAIN.index("\n") + 1 :])

    assert opened.column("t") is None
    assert np.array_equal(opened.read([2, 0]).values, NUMBERS[:, [2, 0]])


def test_the_row_of_units_names_its_columns_too(table):
    opened = table("time,gyro,gyro\n[s],x,y\n0,1,2\n1,2,3\n")

    assert opened.column("x") == 1
    assert opened.column("gyro") is None


def test_names_of_one_byte_letters_are_read(table):
    assert table("t;Winkel [°]\n0,1;2\n".encode("latin-1")).column("Winkel [°]") == 1


@pytest.mark.parametrize("empty", ["", " ", "NaN", "nan", "NA", "null"])
def test_an_empty_cell_is_a_missing_value(table, empty):
    rows = table(PLAIN.replace("2.5,-3", f"{empty},{empty}")).read([0, 1, 2])

    assert rows.dropped == 0
    assert np.isnan(rows.values[1, 1:]).all()
    assert rows.values[1, 0] == 0.01


@pytest.mark.parametrize(
    "bad", ["0.01,2.5", "0.01,2.5,-3,7", "0.01,2.5,x", "0.01,inf,-3", "0.01,1e999,0", "end", '"0.01']
)
def test_a_bad_row_is_left_out_counted_and_known_by_its_line(table, bad):
    rows = table(PLAIN.replace("0.01,2.5,-3", bad)).read([0, 1, 2])

    assert np.array_equal(rows.values, NUMBERS[[0, 2]])
    assert (rows.dropped, rows.first_bad_line) == (1, 3)


def test_text_in_a_column_nobody_asks_for_does_no_harm(table):
    rows = table("t,state,gx\n0,rest,1\n1,walk,2\n").read([0, 2])

    assert np.array_equal(rows.values, [[0, 1], [1, 2]])


def test_a_cell_of_absurd_length_is_a_bad_row(table):
    """The csv module refuses cells above 128 KiB with an error of its own."""
    absurd = f'"{"x" * 200_000}",1,2'

    assert table(f"{absurd}\n{PLAIN}{absurd}\n").read([0, 1, 2]).dropped == 1


def test_bad_rows_far_inside_a_long_table_are_found_and_the_others_kept(table):
    lines = [f"{i},{i % 7},{-i}" for i in range(30_000)]
    for bad in (9_000, 9_001, 29_999):
        lines[bad] = f"{bad},?,0"
    rows = table("t,a,b\n" + "\n".join(lines)).read([0, 1, 2])

    assert (rows.dropped, rows.first_bad_line) == (3, 9_002)
    assert np.array_equal(rows.values[:, 0], [i for i in range(30_000) if i not in {9_000, 9_001, 29_999}])


def test_nothing_usable_is_refused_with_the_first_line_that_is_wrong(table):
    opened = table("t,gx,name\n0,1,a\n1,2,b\n")

    with pytest.raises(RecordingUnreadable) as refusal:
        opened.read([2])
    assert refusal.value.line == 2


@pytest.mark.parametrize(
    "content", ["", "\n\n", "words only\nno numbers\n", "a,b,c\n", b"\x89PNG\r\n\x1a\n\x00\x00", "7\n8\n"]
)
def test_a_file_without_a_table_is_refused_as_a_whole(table, content):
    with pytest.raises(RecordingUnreadable) as refusal:
        table(content)
    assert refusal.value.line == 0


def test_a_missing_file_is_refused(tmp_path):
    for path in (tmp_path, tmp_path / "none.csv"):
        with pytest.raises(RecordingUnreadable):
            open_table(path)


_CELL = st.one_of(
    st.floats(-1e6, 1e6).map(repr), st.sampled_from(["", "nan", " 5 ", "1_0", "0x1", "inf", "-", "a", '"', "٣", "1e5"])
)


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.lists(_CELL, min_size=2, max_size=4), max_size=12))
def test_a_row_counts_the_same_alone_and_among_good_ones(table, rows):
    """The fast parser and the one that looks closer must agree on what a number is."""
    good = "0.5,1,2\n" * 60  # so many that no other width can be the table's
    alone = 0
    for row in rows:
        read = table(good + ",".join(row) + "\n").read([0, 1, 2])
        alone += len(read.values) - 60
    together = table(good + "".join(",".join(row) + "\n" for row in rows)).read([0, 1, 2])

    assert len(together.values) == 60 + alone
    assert np.isfinite(together.values[~np.isnan(together.values)]).all()


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=200))
def test_any_bytes_are_a_table_or_refused(table, content):
    try:
        opened = table(content)
        rows = opened.read(range(opened.width))
    except RecordingUnreadable:
        return

    assert rows.values.shape[1] == opened.width
    assert len(rows.values) + rows.dropped <= len(opened.lines)
