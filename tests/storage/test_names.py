"""F09: whatever a person types, a take gets a folder every system can hold, and nothing is ever overwritten."""

import re
import tempfile
import unicodedata
from datetime import date
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.errors import FolderIsFile, PersonCodeInvalid
from studio.storage.names import SLUG_LIMIT, person_folder, slug
from studio.storage.person_file import Person, save_person
from studio.storage.session_folder import list_takes, make_take_folder, new_session, open_session
from tests.storage.recordings import DAY, start_writing

NASTY = [
    *(
        "",
        ".",
        "..",
        "../../etc/passwd",
        "CON",
        "nul.txt",
        "a/b\\c",
        "x" * 300,
        "trailing. ",
        "C:\\x",
        "walk\n",
        "\x00",
    ),
    *("a:b", "~root", "-rf", "take.mcap", "\u202egnp.exe", "\U0001f3c3\U0001f3fd\u200d\u2640\ufe0f", "e\u0301" * 90),
    *("\u0431\u0435\u0433", "\u6b69\u304f" * 100, "\u00df", "\ufb03", "\u00bd"),
]
names = st.one_of(
    st.sampled_from(NASTY), st.text(max_size=90), st.text(alphabet=st.sampled_from('./\\:*?"<>| -_aA1é'), max_size=90)
)


@settings(max_examples=2000, deadline=None)
@given(names)
def test_a_name_becomes_something_every_system_can_hold(name: str) -> None:
    short = slug(name)

    assert len(short) <= SLUG_LIMIT
    assert len(f"take-001_{short}".encode()) <= 255
    assert not re.search(r'[/\\:*?"<>|.\s\x00-\x1f\x7f]', short)
    assert not any(unicodedata.category(c) in {"Cc", "Cf", "Cs", "Co", "Cn"} for c in short)
    assert short == short.strip("-_ ")
    assert slug(short) == short


@settings(max_examples=150, deadline=None)
@given(st.lists(names, min_size=1, max_size=8))
def test_takes_of_any_names_stay_in_their_session_and_never_meet(typed: list[str]) -> None:
    with tempfile.TemporaryDirectory() as root:
        session = Path(root) / "session"
        session.mkdir()
        folders = [make_take_folder(session, name) for name in typed]

        assert [folder.name[:9].rstrip("_") for folder in folders] == [f"take-{n + 1:03d}" for n in range(len(typed))]
        assert all(folder.resolve().parent == session.resolve() for folder in folders)
        assert sorted(session.iterdir()) == sorted(folders)
        assert list(Path(root).iterdir()) == [session]


def test_numbers_go_on_after_the_highest_one_and_past_999(tmp_path: Path) -> None:
    (tmp_path / "take-999_x").mkdir()
    (tmp_path / "take-007").mkdir()
    (tmp_path / "notes").mkdir()

    assert make_take_folder(tmp_path, "walk").name == "take-1000_walk"


@pytest.mark.parametrize("code", ["P014", "p014", "7", "AB12c", "1234567890123456"])
def test_a_code_is_letters_and_digits(code: str) -> None:
    assert person_folder(code) == code.upper()


@pytest.mark.parametrize(
    "code",
    ["Jane", "A", "P 14", "P-14", "../P14", "Jürgen", "12345678901234567", "P14\n", ".", "CON", "nul", "com1", "１４"],
)
def test_anything_else_is_no_code(code: str) -> None:
    with pytest.raises(PersonCodeInvalid):
        person_folder(code)


def test_sessions_of_one_day_are_lettered(tmp_path: Path) -> None:
    made = [new_session(tmp_path, "P014", DAY).name for _ in range(28)]

    assert made[:2] == ["2026-11-24a", "2026-11-24b"]
    assert made[-3:] == ["2026-11-24z", "2026-11-24aa", "2026-11-24ab"]
    assert open_session(tmp_path, "P014", DAY).name == "2026-11-24ab"
    assert open_session(tmp_path, "P014", date(2026, 11, 25)).name == "2026-11-25a"
    assert open_session(tmp_path, "P015", DAY) == tmp_path / "P015" / "2026-11-24a"


@pytest.mark.parametrize("inside", ["", "of the clinic"])
def test_a_file_where_the_library_should_be_is_named(tmp_path: Path, inside: str) -> None:
    (tmp_path / "library").write_text("a file where a folder should be")

    with pytest.raises(FolderIsFile) as refusal:
        open_session(tmp_path / "library" / inside, "P014", DAY)
    assert refusal.value.path == str(tmp_path / "library")

    with pytest.raises(FolderIsFile):
        save_person(tmp_path / "library" / inside, "P014", Person())


def test_two_takes_of_one_name_are_two_takes(tmp_path: Path) -> None:
    folders = [start_writing(tmp_path).stop().result(30).folder for _ in range(2)]

    assert [folder.name for folder in folders] == ["take-001_walk", "take-002_walk"]
    assert [take.folder for take in list_takes(tmp_path)] == folders
