"""Contacts that begin and end, and sensors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rockfall as rf


def bounce() -> rf.Scene:
    """A ball that bounces, and a capsule that falls through a sensor."""
    scene = rf.Scene()
    scene.settings.contact_law = "rigid"
    scene.settings.gravity = 10
    scene.settings.restitution = 0.5
    scene.add_box((-5, -1, -5), (5, 0, 5))
    scene.add_spheres([(0, 1.5, 0)], 0.5)
    scene.add_capsules([(8, 1, 0)], [(8.5, 1, 0)], 0.1)
    scene.add_sensor("gate", (7, -1, -1), (9, 0, 1))
    return scene


def test_contacts_begin_and_end() -> None:
    sim = rf.Simulation(bounce(), dt=1 / 60, backend="cpu")
    with pytest.raises(ValueError, match="watch_contacts"):
        sim.contact_events()
    sim.watch_contacts()
    sim.run(60)
    events = sim.contact_events()
    assert events["change"].tolist() == ["begin", "end", "begin", "end"]
    assert events["step"].tolist() == [27, 28, 54, 55]
    assert (events["a_kind"] == "sphere").all() and (events["b_kind"] == "box").all()
    assert (events["a"] == 0).all() and (events["b"] == 0).all()
    np.testing.assert_allclose(events["time"], events["step"] / 60, rtol=1e-6)
    np.testing.assert_allclose(events["normal"], [(0, -1, 0)] * 4, atol=1e-6)
    assert events["force"][0, 1] == pytest.approx(-1.5 * 20**0.5 * 60, rel=0.01)
    assert not events["force"][1].any()
    assert len(sim.contact_events()) == 0
    sim.watch_contacts(False)
    with pytest.raises(ValueError, match="watch_contacts"):
        sim.contact_events()


def test_sensors(tmp_path: Path) -> None:
    sim = rf.Simulation(bounce(), dt=1 / 60, backend="cpu")
    assert sim.scene.to_text().count("@sensor name=gate box=7,-1,-1,9,0,1\n") == 1
    with pytest.raises(ValueError, match="watch_sensors"):
        sim.sensor_events()
    sim.watch_sensors()
    assert len(sim.sensor_events()) == 0
    sim.run(30)
    sim.save_checkpoint(tmp_path / "half.ckpt")
    resumed = rf.Simulation.resume(tmp_path / "half.ckpt")
    resumed.watch_sensors()
    found = []
    for part in (sim, resumed):
        part.run(30)
        found.append(part.sensor_events())
    assert found[0]["change"].tolist() == ["enter", "leave"]
    for field in found[0].dtype.names or ():
        assert np.array_equal(found[1][field], found[0][1:][field]), field
    events = found[0]
    assert events["sensor"].tolist() == ["gate", "gate"] and events["kind"].tolist() == ["capsule", "capsule"]
    assert events["index"].tolist() == [0, 0]
    assert events["step"][0] == 27 and events["step"][1] in (38, 39)
    assert (events["centre"][:, 0] == 8.25).all()


def test_wrong_sensors_are_refused() -> None:
    scene = rf.Scene()
    scene.add_sensor("gate", (0, 0, 0), (1, 1, 1))
    with pytest.raises(ValueError, match="a name that no other sensor has"):
        scene.add_sensor("gate", (0, 0, 0), (1, 1, 1))
    with pytest.raises(ValueError, match="six finite numbers"):
        scene.add_sensor("flat", (0, 0, 0), (1, 0, 1))
    with pytest.raises(ValueError, match=r"low: expected shape \(3,\)"):
        scene.add_sensor("flat", (0, 0), (1, 0, 1))
