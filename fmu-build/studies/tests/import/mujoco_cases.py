"""The mechanisms of `mujoco_values.py`, each with its joints, speed, controls and outputs."""

from __future__ import annotations

ARM = '<geom type="capsule" fromto="0 0 0 .5 0 0" size=".02" mass="1"/>'


def model(body: str, rest: str = "", settings: str = "") -> str:
    return f'<mujoco model="case">{settings}<worldbody>{body}</worldbody>{rest}</mujoco>'


def arm(joint: str = "", geom: str = ARM, body: str = "", inner: str = "") -> str:
    return f'<body name="arm" {body}><joint name="swing" axis="0 1 0" {joint}/>{geom}{inner}</body>'


SWING = {"arm.acceleration": {"swing": -1}}
PAIR = {"arm.acceleration": {"swing": -1}, "other.acceleration": {"turn": -1}}


def pair(axis: str = "0 1 0", place: str = ".7 0 .1") -> str:
    geom = '<geom type="capsule" fromto="0 0 0 .2 0 .3" size=".03" mass="2"/>'
    return arm() + f'<body name="other" pos="{place}"><joint name="turn" axis="{axis}"/>{geom}</body>'


def equality(polycoef: str, first: str = "turn", second: str = "swing") -> str:
    return f'<equality><joint joint1="{first}" joint2="{second}" polycoef="{polycoef} 0 0 0"/></equality>'


def four_bar(end: str, rest: str) -> str:
    rod = f'<body name="rod" pos=".1 0 .2"><joint name="pin" axis="0 1 0"/>{end}</body>'
    crank = '<geom type="capsule" fromto="0 0 0 .1 0 .2" size=".01" mass=".4"/>'
    left = f'<body name="crank"><joint name="bearing" axis="0 1 0"/>{crank}{rod}</body>'
    bar = '<geom type="box" pos="0 0 .15" size=".02 .01 .15" mass=".7"/>'
    site = '<site name="tip" pos="0 0 .3"/>'
    right = f'<body name="rocker" pos=".5 0 0"><joint name="pivot" axis="0 1 0" damping=".2"/>{bar}{site}</body>'
    return model(left + right, rest)


ROD = '<geom type="capsule" fromto="0 0 0 .4 0 .1" size=".01" density="3000"/>'
FOUR_BAR = {
    "crank.acceleration": {"bearing": -1},
    "rod.acceleration": {"bearing": -1, "pin": -1},
    "rocker.acceleration": {"pivot": -1},
}
KNEE = (
    '<body name="shank" pos=".5 0 0"><joint name="knee" axis="0 -1 0"/>'
    '<geom type="cylinder" fromto="0 0 0 .1 0 -.4" size=".03" mass="1.5"/></body>'
)
WHEEL = (
    '<body name="wheel" pos="0 0 .1" euler="0 10 0"><joint name="roll" type="slide" axis="1 0 0"/>'
    '<joint name="spin" axis="0 1 0"/><geom type="cylinder" size=".1 .02" euler="90 0 0" mass="3"/>'
    '<geom type="sphere" size=".02" pos=".05 0 0" mass=".5"/></body>'
)
SLIDES = (
    '<body name="one"><joint name="left" type="slide" axis="1 0 0"/><geom size=".1" mass="2"/></body>'
    '<body name="two" pos="1 0 0"><joint name="right" type="slide" axis="1 0 1"/><geom size=".1" mass="3"/></body>'
)
SITES = '<site name="tip" pos=".4 0 0"/>'
POST = '<site name="post" pos=".1 0 .6"/>'
# The reference angle of 15 degrees in the plane of the motion.
RISE = 0.2617993877991494
LIMITS = ' forcerange="-6 9"/>'
WITHOUT_FRICTION = '<option><flag frictionloss="disable"/></option>'
TENDON = '<tendon><spatial name="cord" springlength=".3" {}><site site="post"/><site site="tip"/></spatial></tendon>'
URDF_PAIR = """<robot name="case"><link name="base"/>
<link name="arm"><inertial><origin xyz=".25 0 0"/><mass value="1"/>
<inertia ixx="1" iyy="{iyy}" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="other"><inertial><origin xyz=".1 0 .15"/><mass value="2"/>
<inertia ixx="1" iyy="{other}" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="swing" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
<joint name="turn" type="continuous"><parent link="base"/><child link="other"/><origin xyz=".7 0 .1"/>
<axis xyz="0 1 0"/><mimic joint="swing" multiplier="-1.6" offset="0"/></joint></robot>"""
INERTIAL = '<inertial pos=".25 0 0" mass="7" diaginertia="1 1 1"/>'
CLASSES = (
    '<default><joint damping=".1"/><default class="heavy"><geom density="4000" type="capsule" size=".02"/>'
    '<joint stiffness="3" springref="20"/><default class="light"><geom density="500"/></default></default></default>'
)


SDF_FOUR_BAR = """<sdf version="1.9"><world name="w"><gravity>0 0 -9.81</gravity>
<model name="floor"><static>true</static><link name="plane"/></model>
<model name="case"><pose>1 0 2 0 0 0</pose><frame name="shifted" attached_to="crank"><pose>.1 0 .2 0 0 0</pose></frame>
<link name="crank"><inertial><pose>.05 0 .1 0 {crank_angle} 0</pose><mass>.4</mass><inertia><ixx>{crank_x}</ixx>
<iyy>{crank}</iyy><izz>{crank_x}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link>
<link name="rod"><pose relative_to="shifted">0 0 0 0 30 0</pose><inertial><pose>{rod_x} 0 {rod_z} 0 0 0</pose>
<mass>{rod_mass}</mass><inertia><ixx>1</ixx><iyy>{rod}</iyy><izz>1</izz></inertia></inertial></link>
<link name="rocker"><pose degrees="true">.5 0 0 0 0 0</pose><inertial><pose>0 0 .15 0 0 0</pose><mass>.7</mass>
<inertia><ixx>1</ixx><iyy>{rocker}</iyy><izz>1</izz></inertia></inertial></link>
<joint name="bearing" type="revolute"><parent>world</parent><child>crank</child><axis><xyz>0 1 0</xyz>
<limit><lower>-1e16</lower><upper>1e16</upper></limit></axis></joint>
<joint name="pin" type="continuous"><parent>crank</parent><child>rod</child>
<axis><xyz expressed_in="__model__">0 1 0</xyz></axis></joint>
<joint name="pivot" type="revolute"><parent>world</parent><child>rocker</child><axis><xyz>0 1 0</xyz>
<dynamics><damping>.2</damping><spring_stiffness>0</spring_stiffness><spring_reference>0</spring_reference></dynamics>
</axis></joint>
<joint name="close" type="revolute"><pose>0 0 .3 0 0 0</pose><parent>rod</parent><child>rocker</child>
<axis><xyz>0 1 0</xyz></axis></joint></model></world></sdf>"""
SDF_PAIR = """<sdf version="1.11"><model name="case"><link name="base"><gravity>true</gravity></link>
<link name="arm"><pose>0 0 0 0 0 0</pose><inertial><pose rotation_format="quat_xyzw">.25 0 0 0 0 0 1</pose>
<mass>1</mass><inertia><iyy>{iyy}</iyy></inertia></inertial></link>
<link name="other"><pose>.7 0 .1 0 0 0</pose><inertial><pose>.1 0 .15 0 0 0</pose><mass>2</mass>
<inertia><iyy>{other}</iyy></inertia></inertial></link>
<joint name="swing" type="continuous"><parent>base</parent><child>arm</child><axis><xyz>0 1 0</xyz></axis></joint>
<joint name="turn" type="continuous"><parent>base</parent><child>other</child><axis><xyz>0 1 0</xyz>
<use_parent_model_frame>true</use_parent_model_frame>
<mimic joint="swing"><multiplier>-1.6</multiplier><offset>.8</offset><reference>-.5</reference></mimic></axis></joint>
</model></sdf>"""


def cases() -> list[dict]:
    """Names and texts of the cases, with their outputs."""
    position = '<position name="servo" joint="swing" kp="40" kv="3" gear="2"/>'
    general = (
        '<general name="servo" joint="swing" gainprm="5" biastype="affine" biasprm="1.5 -20 -2" gear="3" damping=".3" '
        'armature=".02"/>'
    )
    list_ = [
        ("capsule", model(arm()), SWING),
        ("gravity disabled", model(arm(), settings='<option><flag gravity="disable"/></option>'), SWING),
        ("gravity in the plane", model(arm(), settings='<option gravity="3 0 -2"/>'), SWING),
        (
            "spring disabled",
            model(
                arm('stiffness="9" damping="2" springref="40"'), settings='<option><flag spring="disable"/></option>'
            ),
            SWING,
            {"speed": 0.7},
        ),
        (
            "damper disabled",
            model(
                arm('stiffness="9" damping="2" springref="40"'), settings='<option><flag damper="disable"/></option>'
            ),
            SWING,
            {"speed": 0.7},
        ),
        ("spring and damper", model(arm('stiffness="9" damping="2" springref="40"')), SWING, {"speed": 0.7}),
        ("frame in a body", model(arm(geom=f'<frame pos=".1 0 .2" euler="0 30 0">{ARM}</frame>')), SWING),
        (
            "joint in a frame",
            model(f'<body name="arm"><frame pos=".1 0 .2"><joint name="swing" axis="0 1 0"/></frame>{ARM}</body>'),
            SWING,
        ),
        ("frame in the world", model(f'<frame pos="1 0 0" euler="0 40 0">{arm()}</frame>'), SWING),
        (
            "class of a frame",
            model(
                '<frame childclass="heavy"><body name="arm"><joint name="swing" axis="0 1 0"/>'
                '<frame childclass="light"><geom fromto="0 0 0 .3 0 0"/></frame>'
                '<geom fromto="0 0 0 0 0 .2"/></body></frame>',
                settings=CLASSES,
            ),
            SWING,
            {"speed": -0.4},
        ),
        (
            "include",
            '<mujoco><include file="arm.xml"/></mujoco>',
            SWING,
            {
                "files": {
                    "arm.xml": '<mujoco><worldbody><body name="arm"><joint name="swing" axis="0 1 0"/>'
                    '<include file="geoms.xml"/></body></worldbody></mujoco>',
                    "geoms.xml": f'<mujoco>{ARM}<geom size=".1" pos="0 0 .4"/></mujoco>',
                }
            },
        ),
        (
            "masses from geoms",
            model(arm('stiffness="5" ref="20"', geom=INERTIAL + ARM), settings='<compiler inertiafromgeom="true"/>'),
            SWING,
        ),
        ("stated masses", model(arm(geom=INERTIAL + ARM)), SWING),
        (
            "groups of geoms",
            model(
                arm(geom=ARM + '<geom size=".2" group="4"/>', joint='stiffness="5" springref="9"'),
                settings='<compiler inertiagrouprange="0 3"/>',
            ),
            SWING,
        ),
        ("total mass", model(arm('stiffness="5" springref="30"'), settings='<compiler settotalmass="10"/>'), SWING),
        (
            "bounds",
            model(
                arm('stiffness="5" springref="30"', geom='<geom size=".01" pos=".2 0 0"/>'),
                settings='<compiler boundmass=".5" boundinertia=".01"/>',
            ),
            SWING,
        ),
        ("reference", model(arm('ref="30" springref="10" stiffness="4"')), SWING),
        (
            "reference in radians",
            model(arm('ref=".5" springref=".1" stiffness="4"'), settings='<compiler angle="radian"/>'),
            SWING,
        ),
        ("armature", model(arm('armature="0.5"')), SWING),
        (
            "zaxis",
            model(
                arm(
                    body='zaxis="1 0 2"',
                    geom='<geom type="box" size=".3 .05 .1" pos=".2 0 .1" mass="2" zaxis="1 0 1"/>',
                )
            ),
            SWING,
        ),
        (
            "xyaxes",
            model(
                arm(
                    body='xyaxes="1 0 1 0 1 0"',
                    geom='<geom type="ellipsoid" size=".3 .05 .1" pos=".2 0 .1" mass="2" xyaxes="1 0 .3 0 1 0"/>',
                )
            ),
            SWING,
        ),
        (
            "order of the turns",
            model(
                f'<body name="arm" euler="90 0 30"><joint name="swing" axis="0 0 1"/>{ARM}</body>',
                settings='<compiler eulerseq="XYZ"/>',
            ),
            {"arm.acceleration": {"swing": 1}},
        ),
        (
            "turns of axes",
            model(
                f'<body name="arm" euler="30 90 0"><joint name="swing" axis="0 0 1"/>{ARM}</body>',
                settings='<compiler eulerseq="yxz"/>',
            ),
            {"arm.acceleration": {"swing": 1}},
        ),
        (
            "axis and angle, quaternion",
            model(
                arm(
                    body='axisangle="0 2 0 25"',
                    geom='<geom type="box" size=".3 .05 .1" pos=".2 0 .1" mass="2" quat="2 0 1 0"/>',
                )
            ),
            SWING,
        ),
        (
            "shapes between ends",
            model(
                arm(
                    geom='<geom type="box" fromto="0 0 0 .3 0 .1" size=".02 .02"/>'
                    '<geom type="ellipsoid" fromto=".3 0 .1 .5 0 0" size=".03 .03"/>'
                    '<geom type="sphere" size=".05" pos=".5 0 0" density="300"/>'
                )
            ),
            SWING,
        ),
        (
            "full inertia",
            model(arm(geom='<inertial pos=".2 0 .1" mass="2" fullinertia=".1 .2 .15 .01 .02 .03"/>')),
            SWING,
        ),
        ("weight carried", model(arm(body='gravcomp=".6"')), SWING),
        (
            "control of the position",
            model(arm('ref="15"'), f"<actuator>{position}</actuator>"),
            SWING,
            {"speed": 0.5, "control": {"servo": 0.3}, "input": {"swing_drive.command": RISE - 0.3 / 2}},
        ),
        (
            "general control",
            model(arm('ref="15"'), f"<actuator>{general}</actuator>"),
            SWING,
            {"speed": 0.5, "control": {"servo": 0.2}, "input": {"swing_drive.command": RISE - 0.2 * 5 / (20 * 3)}},
        ),
        (
            "control of the speed",
            model(arm(), '<actuator><velocity name="servo" joint="swing" kv="4" gear="-3"/></actuator>'),
            SWING,
            {"speed": 0.5, "control": {"servo": 2}, "input": {"swing_drive.command_speed": 2 / 3}, "span": 1.5},
        ),
        (
            "upper limit of the force",
            model(arm(), f"<actuator>{position.replace('/>', LIMITS)}</actuator>"),
            SWING,
            {"speed": 0.5, "control": {"servo": -2.6}, "input": {"swing_drive.command": 1.3}, "span": 1.5},
        ),
        (
            "lower limit of the force",
            model(arm(), f"<actuator>{position.replace('/>', LIMITS)}</actuator>"),
            SWING,
            {"speed": -3.0, "control": {"servo": 2.6}, "input": {"swing_drive.command": -1.3}, "span": 1.5},
        ),
        (
            "two actuators of a joint",
            model(arm(), f'<actuator>{position}<motor name="motor" joint="swing" gear="3"/></actuator>'),
            SWING,
            {
                "control": {"servo": 0.4, "motor": 0.5},
                "input": {"swing_drive.command": -0.2, "swing_drive_2.torque": -1.5},
                "span": 1.5,
            },
        ),
        ("constant friction", model(arm('frictionloss=".5"')), SWING, {"speed": 0.7}),
        ("constant friction backward", model(arm('frictionloss=".5" damping=".1"')), SWING, {"speed": -0.7}),
        ("friction disabled", model(arm('frictionloss=".5"'), settings=WITHOUT_FRICTION), SWING, {"speed": 0.7}),
        (
            "friction and rotor between moving bodies",
            model(
                arm(inner=KNEE.replace('"0 -1 0"', '"0 -1 0" armature=".3" frictionloss=".4"')),
                equality("0 1.4", "knee", "swing"),
            ),
            {"arm.acceleration": {"swing": -1}, "shank.acceleration": {"swing": -1, "knee": 1}},
            {"speed": 1.1},
        ),
        (
            "defaults of drives",
            model(
                arm(),
                '<actuator><velocity name="servo" joint="swing"/></actuator>',
                '<default><general gear="3" gainprm="2"/></default>',
            ),
            SWING,
            {"speed": 0.5},
        ),
        (
            "actuation disabled",
            model(arm(), f"<actuator>{position}</actuator>", '<option><flag actuation="disable"/></option>'),
            SWING,
            {"speed": 0.5},
        ),
        (
            "spring between sites",
            model(arm(inner=SITES) + POST, TENDON.format('stiffness="80" damping="6"')),
            SWING,
            {"speed": 0.9},
        ),
        (
            "drive between sites",
            model(
                arm(inner=SITES) + POST,
                TENDON.format('armature="3"') + '<actuator><motor name="jack" tendon="cord" gear="2"/></actuator>',
            ),
            SWING,
            {"speed": 0.9, "control": {"jack": 5}, "input": {"cord_drive.force": 10}},
        ),
        ("gears", model(pair(), equality("0 -1.6")), PAIR, {"urdf": URDF_PAIR, "sdf": SDF_PAIR}),
        ("gears with equal direction", model(pair(), equality("0 .8")), PAIR),
        (
            "gears with an offset",
            model(pair("0 -1 0"), equality(".3 .8")),
            {"arm.acceleration": {"swing": -1}, "other.acceleration": {"turn": 1}},
        ),
        ("gears with one centre", model(pair(place="0 .1 0"), equality("0 -.7")), PAIR),
        (
            "coupled knee",
            model(arm(inner=KNEE), equality("0 1.4", "knee", "swing")),
            {"arm.acceleration": {"swing": -1}, "shank.acceleration": {"swing": -1, "knee": 1}},
            {"speed": 1.1},
        ),
        (
            "rolling wheel",
            model(WHEEL, equality("0 .1", "roll", "spin")),
            {"wheel.acceleration": {"spin": -1}, "roll.acceleration": {"roll": 1}},
            {"speed": 2.0, "held": "roll"},
        ),
        (
            "coupled slides",
            model(SLIDES, equality("0 -2", "right", "left"), '<option gravity="1 0 -9"/>'),
            {"left.acceleration": {"left": 1}, "right.acceleration": {"right": 1}},
            {"held": "left"},
        ),
        (
            "inertia of a slide",
            model(
                '<body name="one"><joint name="left" type="slide" axis="1 0 1" armature="2"/>'
                '<geom size=".1" mass="2"/></body>'
            ),
            {"left.acceleration": {"left": 1}},
            {"held": "left"},
        ),
        (
            "four-bar by bodies",
            four_bar(ROD, '<equality><connect body1="rod" body2="rocker" anchor=".4 0 .1"/></equality>'),
            FOUR_BAR,
            {"held": "bearing", "speed": 1.5, "sdf": SDF_FOUR_BAR},
        ),
        (
            "four-bar by sites",
            four_bar(
                ROD + '<site name="end" pos=".36 0 .12"/>', '<equality><connect site1="end" site2="tip"/></equality>'
            ),
            FOUR_BAR,
            {"held": "bearing", "speed": 1.5},
        ),
        (
            "weld",
            four_bar(
                ROD,
                '<equality><connect body1="rod" body2="rocker" anchor=".4 0 .1"/>'
                '<weld body1="flag" body2="rod"/></equality>',
            ).replace(
                "</worldbody>",
                '<body name="flag" pos=".3 0 .6"><joint name="wave" type="slide" axis="0 0 1"/>'
                '<joint name="wave2" type="slide" axis="1 0 0"/><joint name="wave3" axis="0 1 0"/>'
                '<geom size=".05" mass=".3"/></body></worldbody>',
            ),
            FOUR_BAR,
            {"held": "bearing", "speed": 1.5},
        ),
    ]
    return [
        dict(zip(("name", "mjcf", "outputs"), case, strict=False)) | (case[3] if len(case) > 3 else {})
        for case in list_
    ]
