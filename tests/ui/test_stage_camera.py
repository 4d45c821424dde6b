"""The camera: where points of the world fall on the picture, and how the body is followed."""

import math

import numpy as np
import pytest

from studio.core.body import Segment
from studio.ui.views.stage.camera import NEAR, VIEWS, Camera, standing
from studio.ui.views.stage.cameraman import SWING, Cameraman
from tests.ui.stage_poses import FRAME, SKELETON, walking
from tests.ui.stage_poses import standing as body

TARGET = np.array([0.0, 0.0, 0.9])
LEFT_HAND = np.array([0.0, 0.8, 1.4])


def camera(view="front", from_behind=False, heading=0.0):
    return standing(view, 1.75, heading, from_behind, TARGET)


@pytest.mark.parametrize("heading", [0.0, 1.0, -2.5])
def test_the_wearers_left_is_on_the_right_from_the_front_and_on_the_left_from_behind(heading):
    left = np.array([-math.sin(heading), math.cos(heading), 1.4])

    assert camera(heading=heading).project(left)[0] > 320
    assert camera(heading=heading, from_behind=True).project(left)[0] < 320


def test_from_the_side_the_right_arm_is_near_and_walking_goes_to_the_right():
    side = camera("side")

    assert side.seen(np.array([0.0, -0.8, 1.4]))[2] < side.seen(LEFT_HAND)[2]
    assert side.project(np.array([1.0, 0.0, 0.9]))[0] > 320


def test_from_above_the_front_is_down_and_height_does_not_show():
    top = camera("top")

    assert top.project(np.array([0.5, 0.0, 0.9]))[1] > 240
    assert top.project(np.array([0.0, 0.0, 1.7])) == pytest.approx([320, 240], abs=1.0)


def test_a_metre_at_the_target_is_as_long_as_focal_length_and_distance_say():
    seen = camera("front")
    one, other = seen.project(np.array([[0.0, -0.5, 0.9], [0.0, 0.5, 0.9]]))

    assert other[0] - one[0] == pytest.approx(seen.focal / seen.distance)


def test_what_is_twice_as_far_is_half_as_long():
    eye = Camera((0.0, 0.0, 1.0), 0.0, 0.0, 4.0)
    near, far = (np.ptp(eye.project(np.array([[x, 0.0, 1.0], [x, 0.0, 2.0]]))[:, 1]) for x in (0.0, -4.0))

    assert near == pytest.approx(2 * far)


def test_the_floor_far_away_comes_to_the_horizon():
    seen = camera("free")
    forward = -seen.axes[2] * (1.0, 1.0, 0.0)

    assert seen.project(1e7 * forward)[1] == pytest.approx(seen.horizon, abs=0.01)


def test_what_is_nearer_than_the_lens_or_behind_has_no_place():
    eye = Camera((0.0, 0.0, 1.0), 0.0, 0.0, 4.0)

    assert np.isnan(eye.project(np.array([4.0 - 0.5 * NEAR, 0.0, 1.0]))).all()
    assert np.isnan(eye.project(np.array([9.0, 0.0, 1.0]))).all()


@pytest.mark.parametrize("size", [(240, 180), (1000, 700), (3840, 2160), (400, 1000)])
@pytest.mark.parametrize("view", VIEWS)
def test_the_whole_body_is_in_the_picture_at_every_size(size, view):
    cameraman = Cameraman()
    cameraman.frame(size[0], size[1], 0.0)
    cameraman.see(body("t"))
    cameraman.choose(view, None)

    points = cameraman.camera.project(body("t").joints)

    assert (points > 0).all()
    assert (points < size).all()


def test_a_drag_turns_the_eye_and_never_over_the_top():
    turned = camera().orbited(100, 5000)

    assert turned.azimuth != camera().azimuth
    assert turned.elevation < math.pi / 2
    assert camera().orbited(0, -5000).elevation > -math.pi / 2


def test_a_pan_moves_the_picture_by_as_many_pixels():
    before = camera("free").project(TARGET)
    after = camera("free").moved(30, -20).project(TARGET)

    assert after - before == pytest.approx([30, -20], abs=0.5)


def test_a_body_that_appears_is_looked_at_at_once():
    cameraman = Cameraman()
    cameraman.see(body(at=(12.0, -7.0)))

    assert cameraman.camera.target[:2] == pytest.approx((12.0, -7.0))


def test_one_who_walks_evenly_comes_to_the_middle():
    cameraman = Cameraman()
    for frame in range(600):
        cameraman.see(body(at=(1.3 * frame * FRAME, 0.0)))
        cameraman.advance(FRAME, frame * FRAME)

    assert cameraman.camera.target[0] == pytest.approx(1.3 * 599 * FRAME, abs=0.03)


def test_steps_do_not_shake_the_picture():
    """The hips of a walking body go up and down by 4 cm twice a second; the camera by less than a quarter of that."""
    cameraman, hips, target = Cameraman(), [], []
    for frame, pose in enumerate(walking(8.0)):
        cameraman.see(pose)
        cameraman.advance(FRAME, frame * FRAME)
        hips.append(pose.joints[Segment.Hips, 2])
        target.append(cameraman.camera.target[2])

    assert np.ptp(target[240:]) < 0.25 * np.ptp(hips[240:])


def test_without_following_the_camera_stays():
    cameraman = Cameraman()
    cameraman.see(body())
    cameraman.set_follow(False)
    before = cameraman.camera
    cameraman.see(body(at=(1.0, 0.0)))

    assert not cameraman.advance(FRAME, 0.0)
    assert cameraman.camera == before


def test_a_body_elsewhere_is_another_moment_and_nothing_travels_there():
    cameraman = Cameraman()
    cameraman.see(body())
    cameraman.see(body(at=(8.0, 0.0)))

    assert cameraman.camera.target[0] == pytest.approx(8.0)


def test_a_view_is_reached_smoothly_and_exactly():
    cameraman = Cameraman()
    cameraman.see(body())
    cameraman.choose("side", 0.0)
    begin = cameraman.camera.azimuth
    cameraman.advance(FRAME, SWING / 2)
    middle = cameraman.camera.azimuth
    cameraman.advance(FRAME, SWING)

    assert begin > middle > cameraman.camera.azimuth
    assert cameraman.camera.azimuth == pytest.approx(-math.pi / 2)


def test_the_front_is_the_wearers_own():
    cameraman = Cameraman()
    cameraman.see(body(turned=math.radians(120)))
    cameraman.choose("front", None)

    assert cameraman.camera.azimuth == pytest.approx(math.radians(120))


def test_a_panned_picture_stays_panned_while_following_until_a_view_is_chosen():
    cameraman = Cameraman()
    cameraman.see(body())
    cameraman.pan(80, 0)
    for frame in range(120):
        cameraman.advance(FRAME, frame * FRAME)
    panned = cameraman.camera.project(body().joints[Segment.Hips])[0]
    cameraman.choose("free", None)

    assert panned == pytest.approx(400, abs=1.0)
    assert cameraman.camera.project(body().joints[Segment.Hips])[0] == pytest.approx(320, abs=1.0)


def test_a_stall_does_not_throw_the_camera():
    cameraman = Cameraman()
    cameraman.see(body())
    cameraman.see(body(at=(1.0, 0.0)))
    cameraman.advance(5.0, 5.0)

    assert 0.0 < cameraman.camera.target[0] < 1.0


def test_an_unknown_view_is_our_mistake():
    with pytest.raises(ValueError, match="no view is called"):
        Cameraman().choose("below", None)  # type: ignore[arg-type]  # as a settings file might


def test_the_middle_of_the_body_is_the_middle_of_the_picture():
    cameraman = Cameraman()
    cameraman.see(body())
    cameraman.choose("front", None)
    feet, crown = np.array([0.0, 0.0, 0.0]), np.array([0.0, 0.0, SKELETON.stature])
    low, high = cameraman.camera.project(np.stack([feet, crown]))[:, 1]

    assert (low + high) / 2 == pytest.approx(240, abs=8.0)
    assert 0.6 < (low - high) / 480 < 0.85
