"""What messages recommend works in Python, too: arguments by the names of calls, not options of the command."""
import re

import numpy as np
import pytest

import vog
from vog._messages import spoken


def message_of(call):
    with pytest.raises((vog.Error, TypeError, ValueError)) as error:
        call()
    text = str(error.value)
    assert "--" not in text and "\n" not in text, text
    return text


def ball(lowest=0.0):
    x = np.linspace(-1, 1, 12)
    return np.maximum(1 - np.sqrt(x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2), lowest).astype(np.float32)


def test_values_that_are_no_density(tmp_path):
    signed, holes = ball(-0.5), ball()
    holes[4, 4, 4] = np.nan
    for array, argument in ((signed, "clip_negative"), (holes, "skip_nonfinite")):
        assert argument in message_of(lambda: vog.Volume.from_numpy(array))
        vog.Volume.from_numpy(array, **{argument: True})
    text = tmp_path / "points.csv"
    text.write_text("x,y,z\n0,0,0\n1,0,0\nnan,1,1\n0,1,1\n")
    assert "skip_nonfinite=True" in message_of(lambda: vog.Points.load(text))
    vog.Points.load(text, skip_nonfinite=True)


def test_particles_at_one_place_need_a_radius():
    points = vog.Points.from_numpy(np.zeros((5, 3)))
    assert "radius='X'" in message_of(lambda: vog.convert(points))
    vog.convert(points, radius=1.0)


def test_fields():
    volume = vog.Volume.from_numpy(ball())
    model = vog.convert(volume, block=4, fields=False)
    assert "fields=..." in message_of(lambda: vog.render(model, show="mean", field="heat", size=16))
    assert "fields=..." in message_of(lambda: vog.render(model, show="volume", size=16))
    vog.render(vog.convert(volume, block=4), show="volume", size=16)
    vog.render(vog.convert(volume, block=4, fields={"heat": ball()}), show="volume", field="heat", size=16)


def test_volumes_at_one_place():
    volumes = [vog.Volume.from_numpy(ball()), vog.Volume.from_numpy(ball())]
    assert "Levels(volumes, force=True)" in message_of(lambda: vog.Levels(volumes))
    vog.Levels(volumes, force=True)


@pytest.mark.parametrize("show", ["volume", "maximum"])
def test_errors_name_the_call_once(show):
    model = vog.convert(vog.Volume.from_numpy(ball()), block=4)
    for named in ({"clip": [1, 2]}, {"clip_planes": [[1, 2]]}, {"field": "none"}, {"fields": {"a": 1}}):
        assert re.match("render: (?!render)", message_of(lambda: vog.render(model, size=8, show=show, **named)))
    for named in ({"fields": {"a": 1}}, {"field": "a"}, {"field": "b", "fields": {"a": ball()}}):
        assert re.match("render: (?!render)", message_of(lambda: vog.render(vog.Volume.from_numpy(ball()), size=8, show=show, **named)))


@pytest.mark.parametrize(
    "text, said",
    [
        ("the largest of 2 grids; --grid chooses another: flames", "the largest of 2 grids; grid=... chooses another: flames"),
        ("three columns of places (--columns names others)", "three columns of places (columns=... names others)"),
        ("all lie at one place (--radius X)", "all lie at one place (radius='X')"),
        ("smaller than a half's step (--units box)", "smaller than a half's step (units='box')"),
        ("--skip-nonfinite leaves such voxels out", "skip_nonfinite=True leaves such voxels out"),
    ],
)
def test_options_in_messages_become_arguments(text, said):
    assert spoken(text) == said
