"""Which words open the simulated suit, and that no others do."""

import math

import pytest

from studio.acquisition.synthetic.words import SCRIPTS, read_words
from studio.core.body import PLACES, Place
from studio.core.errors import SourceUnreadable


@pytest.mark.parametrize("words", ["", "?", "walk", "walk?"])
def test_no_words_are_a_walk_with_all_tags_in_real_time(words):
    options = read_words(words)

    assert (options.script, options.places, options.speed, options.loss) == ("walk", PLACES, 1.0, 0.0)


@pytest.mark.parametrize("script", SCRIPTS)
def test_every_script_is_called_by_its_name(script):
    assert read_words(f"{script}?tags=3&speed=max").script == script


def test_options_are_read():
    options = read_words(
        "sit?tags=lower&loss=0.2&burst=4&seed=7&calibrated=0&speed=max&skew=40&reboot=12.5@left_foot"
        "&swap=left_foot:right_foot&battery=low&rate=100&stature=1.62"
    )

    assert [place.number for place in options.places] == [9, 10, 11, 12, 13, 14, 15]
    assert (options.loss, options.burst, options.seed, options.calibrated) == (0.2, 4.0, 7, False)
    assert (options.speed, options.skew, options.frame_s, options.stature) == (math.inf, 40.0, 0.01, 1.62)
    assert (options.reboot, options.reboot_place) == (12.5, Place.LEFT_FOOT)
    assert options.swap == (Place.LEFT_FOOT, Place.RIGHT_FOOT)
    assert options.low_battery


def test_n_tags_are_the_first_n_rows_of_table_1():
    assert read_words("?tags=4").places == PLACES[:4]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("dance", "no script is called dance"),
        ("walk?colour=red", "no option colour"),
        ("walk?loss", "must be a number"),
        ("walk?loss=1", "from 0 to 0.9"),
        ("walk?loss=nan", "from 0 to 0.9"),
        ("walk?tags=0", "from 1 to 15"),
        ("walk?tags=2.5", "whole number"),
        ("walk?tags=left", "must be a number"),
        ("walk?speed=0", "from 0.01"),
        ("walk?speed=-1", "from 0.01"),
        ("walk?calibrated=yes", "0 or 1"),
        ("walk?battery=full", "must be low"),
        ("walk?rate=60", "50 or 100"),
        ("walk?loss=0.8&burst=2", "outages of 2 frames cannot lose 0.8"),
        ("walk?swap=head", "no place is called empty"),
        ("walk?swap=head:head", "swapped with itself"),
        ("walk?tags=upper&swap=head:left_foot", "no tag is worn at left_foot"),
        ("walk?tags=upper&reboot=3@pelvis", "no tag is worn at pelvis"),
        ("walk?reboot=soon", "must be a number"),
        ("walk?stature=17", "from 0.8 to 2.3"),
        ("walk?seed=-1", "from 0"),
    ],
)
def test_words_that_make_no_sense_are_refused_with_the_reason(words, reason):
    with pytest.raises(SourceUnreadable) as refused:
        read_words(words)

    assert refused.value.source == f"synthetic:{words}"
    assert reason in refused.value.reason
