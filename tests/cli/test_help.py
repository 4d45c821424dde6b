"""``--help`` explains the words of a verb and shows an example that is accepted."""

import shlex

import pytest

from studio.cli import main
from studio.cli.arguments import parser
from studio.cli.help_texts import COMMAND
from studio.core.attitude import ESTIMATORS
from studio.export import bvh, csv_tables

VERBS = ("devices", "record", "import", "inspect", "solve", "export")


def help_of(capsys, *words):
    with pytest.raises(SystemExit) as end:
        main([*words, "--help"])
    assert end.value.code == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("verb", VERBS)
def test_each_verb_shows_an_example_that_it_understands(verb, capsys):
    shown = help_of(capsys, verb)

    (example,) = [line.strip() for line in shown.splitlines() if line.startswith(f"  {COMMAND} {verb}")]
    words = shlex.split(example.removeprefix(COMMAND))
    assert parser().parse_args(words).verb == verb


def test_the_top_names_every_verb(capsys):
    shown = help_of(capsys)

    for verb in VERBS:
        assert f"    {verb} " in shown


@pytest.mark.parametrize("verb", ["solve", "export"])
def test_what_can_be_chosen_is_explained(verb, capsys):
    shown = help_of(capsys, verb)
    explained = shown[shown.index("attitude     ") :]

    for word in (*ESTIMATORS, "offline", "live", "recorded", "latest", "n (N-pose)", "bow", "sit"):
        assert word in explained


def test_every_preset_is_explained(capsys):
    shown = help_of(capsys, "export")
    explained = shown[shown.index("presets      ") :]

    for preset in (*bvh.PRESETS, *csv_tables.PRESETS):
        assert preset in explained
    assert "decimal comma" in explained
    assert "byte order" in explained


def test_help_fits_a_terminal(capsys):
    for words in ((), *((verb,) for verb in VERBS)):
        assert max(len(line) for line in help_of(capsys, *words).splitlines()) <= 120
