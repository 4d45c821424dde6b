"""Numbers as text: what Python's own formatting writes, faster."""

import locale

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.export.number_format import Numbers, Punctuation, Words, as_text

SPACES = Punctuation(b".", b" ", b"\n")


def written(values, decimals, punctuation=SPACES):
    return as_text([Numbers(np.atleast_2d(np.asarray(values, np.float64)), decimals)], punctuation).decode()


@pytest.mark.parametrize("decimals", [0, 6, 9])
@pytest.mark.parametrize("largest", [1.0, 3600.0, 99_999.0, 1e7, 1e12])
def test_digits_are_those_of_python(decimals, largest):
    values = np.random.default_rng(0).uniform(-largest, largest, (500, 7))

    lines = written(values, decimals).splitlines()

    read = np.array([[float(cell) for cell in line.split(" ")] for line in lines])
    # Half a unit of the last decimal, and the rounding of the double the text is read into.
    np.testing.assert_allclose(read, values, atol=0.5 * 10.0**-decimals * (1 + 1e-6), rtol=3e-16)
    python = [f"{round(value, decimals) + 0.0:.{decimals}f}" for value in values.ravel().tolist()]
    ours = [cell for line in lines for cell in line.split(" ")]
    # A tie may go either way: the scaled value is rounded, not the decimal expansion of the double.
    assert np.mean([one == other for one, other in zip(ours, python, strict=True)]) > 0.99


@given(st.lists(st.floats(-1e15, 1e15), min_size=1, max_size=5))
def test_any_number_is_read_back_within_half_a_millionth(values):
    read = [float(cell) for cell in written(values, 6).split()]

    np.testing.assert_allclose(read, values, atol=0.5e-6 * (1 + 1e-6), rtol=3e-16)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0.000000"),
        (-0.0, "0.000000"),
        (-1e-9, "0.000000"),
        (-0.5, "-0.500000"),
        (9999.9999999, "10000.000000"),
        (-12345.678, "-12345.678000"),
        (10000.000001, "10000.000001"),
        (99999999.9999999, "100000000.000000"),
        (float("nan"), ""),
    ],
)
def test_the_awkward_numbers(value, text):
    assert written(value, 6) == text + "\n"


def test_a_missing_cell_stays_between_its_separators():
    assert written([1.0, np.nan, 3.0], 6) == "1.000000  3.000000\n"


def test_words_and_numbers_stand_in_one_row_with_a_decimal_comma():
    numbers = Numbers(np.array([[1.5], [np.nan]]), 6)
    words = Words(np.array([1, 0]), (b"", b"left"))
    whole = Numbers(np.ones((2, 2)), 0)

    assert as_text([numbers, words, whole], Punctuation(b",", b";")) == b"1,500000;left;1;1\r\n;;1;1\r\n"


def test_infinity_is_our_own_mistake():
    with pytest.raises(ValueError, match="infinite"):
        written([1.0, np.inf], 6)


def test_other_numbers_of_decimals_are_not_offered():
    with pytest.raises(ValueError, match="4 decimals"):
        written(1.0, 4)


def test_a_german_process_writes_points():
    before = locale.setlocale(locale.LC_NUMERIC)
    names = ("de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8")
    available = [name for name in names if _can_set(name)]
    try:
        if available:  # without such a locale on this machine the plain one is as good as it gets
            locale.setlocale(locale.LC_NUMERIC, available[0])
        assert written(1234.5, 6) == "1234.500000\n"
        assert written(1e12 + 0.5, 6) == "1000000000000.500000\n"
    finally:
        locale.setlocale(locale.LC_NUMERIC, before)


def _can_set(name):
    before = locale.setlocale(locale.LC_NUMERIC)
    try:
        locale.setlocale(locale.LC_NUMERIC, name)
    except locale.Error:
        return False
    locale.setlocale(locale.LC_NUMERIC, before)
    return True
