"""Scenes of robots for environments. Their y axis points up."""

from __future__ import annotations

import numpy as np

from rockfall._rigid import Shape
from rockfall._scene import Scene

#: Half the size of the ground, in units.
_FAR = 500.0
#: Groups of the parts of a robot, and of what touches nothing. That of the ground is 0.
_PARTS, _NOTHING = 1, 2
#: Height of the torso of a hopper and of an ant in their scenes, in units, and angle of the ankles of an ant, in rad.
HOPPER_HEIGHT, ANT_HEIGHT, ANKLE = 1.25, 0.75, 1.0
#: Legs of an ant: sign along x, sign along -z, and sign of the angle of the ankle.
LEGS = ((1.0, 1.0, 1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, -1.0), (1.0, -1.0, 1.0))


def _empty(friction: float) -> Scene:
    """A scene whose parts of robots touch the ground and not each other."""
    scene = Scene()
    scene.settings.update(contact_law="rigid", gravity=9.81, coulomb_friction=friction, restitution=0.0)
    scene.set_group_meets(_PARTS, [0])
    scene.set_group_meets(_NOTHING, [])
    return scene


def _add_ground(scene: Scene) -> None:
    scene.add_box([-_FAR, -1.0, -_FAR], [_FAR, 0.0, _FAR])


def cart_pole() -> Scene:
    """A cart on a rail along x with a pole on a hinge: the scene of :class:`CartPoleEnv`.

    The cart has a mass of 1, and the pole a mass of 0.1 and a length of 1 unit. The joints are ``slide`` and ``hinge``. The
    hinge turns clockwise as seen from +z, so a positive angle leans toward +x. Gravity is 9.81 units/s² along -y.
    """
    scene = _empty(0.0)
    cart = scene.add_shape(Shape(mass=1.0).box([-0.2, -0.1, -0.15], [0.2, 0.1, 0.15], group=_NOTHING))
    # The pole has the inertia of a thin rod.
    rod = Shape(mass=0.1, centre=[0, 0.5, 0], inertia=[0.1 / 12, 1e-5, 0.1 / 12, 0, 0, 0])
    pole = scene.add_shape(rod.box([-0.05, 0.0, -0.05], [0.05, 1.0, 0.05], group=_NOTHING))
    scene.add_box([-3.0, -0.13, -0.2], [3.0, -0.1, 0.2], group=_NOTHING, colour="#9aa3ad")
    bodies = [scene.add_body(cart, [0, 0, 0], colour="#39424e"), scene.add_body(pole, [0, 0, 0], colour="#c9a25e")]
    scene.add_joint("slider", None, bodies[0], at=[0, 0, 0], axis=[1, 0, 0], name="slide")
    scene.add_joint("hinge", bodies[0], bodies[1], at=[0, 0, 0], axis=[0, 0, -1], name="hinge")
    return scene


def hopper() -> Scene:
    """A leg with a torso and a foot that moves in the plane of x and y: the scene of :class:`HopperEnv`.

    The joints are ``rail`` (along x), ``lift`` (along y), ``turn``, ``thigh``, ``leg`` and ``foot``, and the bodies two
    carriers of 0.1 kg between world and torso, then torso, thigh, leg and foot. Lengths and masses are those of Gymnasium's
    hopper.
    """
    scene = _empty(2.0)
    _add_ground(scene)
    carrier = scene.add_shape(Shape(mass=0.1).sphere([0, 0, 0], 0.04, group=_NOTHING))
    before = None
    for name, axis in (("rail", [1, 0, 0]), ("lift", [0, 1, 0])):
        body = scene.add_body(carrier, [0, HOPPER_HEIGHT, 0], look="glass")
        scene.add_joint("slider", before, body, at=[0, HOPPER_HEIGHT, 0], axis=axis, name=name)
        before = body
    parts = (
        ("turn", [0, 1.05, 0], [0, 1.45, 0], 0.05, [0, HOPPER_HEIGHT, 0], -1.0, None),
        ("thigh", [0, 1.05, 0], [0, 0.6, 0], 0.05, [0, 1.05, 0], 1.0, (-150.0, 0.0)),
        ("leg", [0, 0.6, 0], [0, 0.1, 0], 0.04, [0, 0.6, 0], 1.0, (-150.0, 0.0)),
        ("foot", [-0.13, 0.1, 0], [0.26, 0.1, 0], 0.06, [0, 0.1, 0], 1.0, (-45.0, 45.0)),
    )
    for name, end1, end2, radius, at, sign, degrees in parts:
        shape = scene.add_shape(Shape(density=1000.0).capsule(end1, end2, radius, group=_PARTS))
        body = scene.add_body(shape, [0, 0, 0], colour="#d9823f")
        limits = None if degrees is None else (float(np.radians(degrees[0])), float(np.radians(degrees[1])))
        scene.add_joint("hinge", before, body, at=at, axis=[0, 0, sign], limits=limits, name=name)
        before = body
    return scene


def ant() -> Scene:
    """A ball with four legs of two links: the scene of :class:`AntEnv`.

    The joints are ``hip_1``, ``ankle_1`` and so on to ``ankle_4``, and the first body is the torso. Lengths and densities are
    those of Gymnasium's ant. The parts touch the ground and not each other.
    """
    scene = _empty(1.0)
    _add_ground(scene)
    middle = np.array([0.0, ANT_HEIGHT, 0.0])
    # What its parts have in common counts for each of them, as in Gymnasium's ant.
    trunk = Shape(mass=0.4839).sphere([0, 0, 0], 0.25, group=_PARTS)
    for along, across, _ in LEGS:
        trunk.capsule([0, 0, 0], [0.2 * along, 0, -0.2 * across], 0.08, group=_PARTS)
    torso = scene.add_body(scene.add_shape(trunk), middle, colour="#c9a25e")
    for number, (along, across, sign) in enumerate(LEGS, 1):
        out = np.array([along, 0.0, -across])
        hip, ankle = middle + 0.2 * out, middle + 0.4 * out
        foot = ankle + 0.4 * (np.cos(ANKLE) * out - [0.0, np.sqrt(2.0) * np.sin(ANKLE), 0.0])
        links = [
            scene.add_body(scene.add_shape(Shape(density=5.0).capsule(a, b, 0.08, group=_PARTS)), [0, 0, 0], colour=colour)
            for a, b, colour in ((hip, ankle, "#8a6f3f"), (ankle, foot, "#39424e"))
        ]
        side = float(np.radians(30.0))
        scene.add_joint("hinge", torso, links[0], at=hip, axis=[0, 1, 0], limits=(-side, side), name=f"hip_{number}")
        # About its axis, a positive angle bends the ankles 1 and 4 down, and the others up.
        room = sorted(sign * (float(np.radians(degrees)) - ANKLE) for degrees in (30.0, 70.0))
        axis = sign * np.array([-across, 0.0, -along])
        scene.add_joint(
            "hinge", links[0], links[1], at=ankle, axis=axis, limits=(room[0], room[1]), name=f"ankle_{number}"
        )
    return scene
