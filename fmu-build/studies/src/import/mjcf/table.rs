//! Treatment of each element and attribute of MJCF.
//!
//! The page of the reference is written from this table. A test compares it with the importer, and with the elements
//! and attributes of MuJoCo.

use super::super::xml::{Element, Fate, Row};
use Fate::{LeftOut, NoEffect, Read, Rejected};

/// Actuators, whose defaults share attributes.
pub const ACTUATORS: [&str; 12] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "orientation",
    "pid",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
];
/// Attributes that the defaults of all actuators share.
pub const SHARED: [&str; 13] = [
    "gear",
    "damping",
    "armature",
    "ctrllimited",
    "ctrlrange",
    "forcelimited",
    "forcerange",
    "cranklength",
    "delay",
    "nsample",
    "interp",
    "group",
    "user",
];

/// Elements in bodies and in frames of bodies have one group.
pub fn group(tag: &str) -> String {
    if matches!(tag, "worldbody" | "frame") { "body".to_owned() } else { tag.to_owned() }
}

const POSE: &str = "`import` reads the position and orientation, with the angle unit and rotation order of \
    `compiler`";
const SOFT: &str = "the limits, connections and couplings in the definition are rigid";
const TOUCH: &str = "the entry concerns contacts between bodies, which `import` does not read";
const LOOK: &str = "the entry is used only for drawing, or as a name for other programs";
const SOLVER: &str = "the entry is a setting of MuJoCo's solver, which `import` does not need";
const DRIVE: &str = "the drive of the definition follows its input without delay and without limits";

#[rustfmt::skip]
pub const TABLE: &[Row] = &[
    ("mujoco/compiler", "", Read, "`import` reads the settings of the file, which the next rows list"),
    ("mujoco/compiler", "angle eulerseq", Read, "`import` reads the unit of all angles and the order of the \
        rotations in `euler`"),
    ("mujoco/compiler", "autolimits", Read, "if true, a joint with a `range` and without `limited` has limits"),
    ("mujoco/compiler", "inertiafromgeom inertiagrouprange", Read, "these attributes select the bodies whose masses \
        `import` computes from geoms, and these geoms"),
    ("mujoco/compiler", "settotalmass", Read, "`import` scales all masses so that their sum is equal to this total \
        mass"),
    ("mujoco/compiler", "boundmass boundinertia", Read, "`import` reads the smallest allowed mass and the smallest \
        allowed moment of inertia of a body"),
    ("mujoco/compiler", "coordinate", Rejected("local"), "global coordinates are not supported: save the file with a \
        newer version of MuJoCo"),
    ("mujoco/compiler", "balanceinertia", LeftOut, "the attribute corrects only moments of inertia that are \
        impossible for a rigid body"),
    ("mujoco/compiler", "alignfree assetdir conflict discardvisual fitaabb fusestatic meshdir passthrough \
        savecanonical savecompiled saveinertial strippath texturedir usethread", NoEffect, "they concern files, \
        drawing, or the program MuJoCo itself"),
    ("compiler/lengthrange", "", NoEffect, "the element is used only for muscles"),
    ("mujoco/option", "", Read, "`import` reads the settings of the simulation, which the next rows list"),
    ("mujoco/option", "gravity", Read, "`import` reads the gravity of the model, and uses its part in the plane of \
        motion"),
    ("mujoco/option", "density viscosity", Rejected("0"), "`import` cannot convert a surrounding medium: set \
        `density` and `viscosity` to 0, and add the key `air` to the definition"),
    ("mujoco/option", "wind magnetic actuatorgroupdisable", LeftOut, "the attribute concerns a surrounding medium, \
        sensors or groups of actuators"),
    ("mujoco/option", "ccd_iterations ccd_tolerance cone impratio integrator iterations jacobian ls_iterations \
        ls_tolerance noslip_iterations noslip_tolerance o_friction o_margin o_solimp o_solref sdf_initpoints \
        sdf_iterations sleep_tolerance solver timestep tolerance collision apirate mpr_iterations mpr_tolerance",
        NoEffect, SOLVER),
    ("option/flag", "", Read, "the attributes switch parts of the simulation on or off"),
    ("option/flag", "gravity spring damper limit equality frictionloss actuation constraint", Read,
        "with `disable`, the definition contains no gravity, springs, dampers, limits, equalities, friction losses or \
            actuators; `constraint` means limits, equalities and friction losses together"),
    ("option/flag", "contact", Read, "with `disable`, `import` prints no note about contacts"),
    ("option/flag", "clampctrl autoreset diagexact energy eulerdamp filterparent fwdinv invdiscrete ipc island \
        midphase multiccd nativeccd override refsafe sensor sleep speculative warmstart passive", NoEffect, SOLVER),
    ("mujoco/size mujoco/statistic mujoco/visual mujoco/custom mujoco/asset", "", NoEffect, LOOK),
    ("mujoco/default", "", NoEffect, "no part of the definition corresponds to this element; `import` uses its \
        attributes as defaults of the class"),
    ("mujoco/include", "file", Read, "`import` also reads the file with this name, in the folder of the imported \
        file"),
    ("mujoco/extension mujoco/deformable", "", Rejected(""), "plugins and deformable bodies are not supported: remove \
        plugins and deformable bodies"),
    ("mujoco/contact", "", LeftOut, "contacts between bodies are not imported"),
    ("mujoco/sensor", "", LeftOut, "the outputs of the definition replace sensors"),
    ("mujoco/keyframe", "", LeftOut, "the start position is the position of the bodies in the file"),

    ("mujoco/worldbody", "", Read, "the element becomes the body `ground`"),
    ("mujoco/worldbody", "childclass", Read, "the attribute states the default class of all elements inside the \
        element"),
    ("mujoco/worldbody", "name", NoEffect, LOOK),
    ("body/body", "", Read, "the element becomes a body; a body without joints is fixed to the body that contains it"),
    ("body/body body/frame", "pos quat axisangle euler xyaxes zaxis", Read, POSE),
    ("body/body", "name childclass", Read, "`import` reads the name of the body, and the default class of all \
        elements inside the body"),
    ("body/body", "gravcomp", Read, "the body gets a constant upward force, which the attribute states as a fraction \
        of the weight"),
    ("body/body", "mocap", LeftOut, "the body does not move"),
    ("body/body", "fuse simple sleep user", NoEffect, SOLVER),
    ("body/frame", "", Read, "`import` reads the position and orientation of all elements in the frame"),
    ("body/frame", "childclass", Read, "the attribute states the default class of all elements inside the element"),
    ("body/frame", "name", NoEffect, LOOK),
    ("body/replicate body/attach body/composite", "", Rejected(""), "`import` does not copy models: save the compiled \
        model with mj_saveLastXML of MuJoCo, and import the saved file"),
    ("body/flexcomp body/plugin geom/plugin", "", Rejected(""), "plugins and deformable bodies are not supported: \
        remove plugins and deformable bodies"),
    ("body/inertial", "", Read, "`import` reads the mass, centre and moment of inertia of the body"),
    ("body/inertial", "mass diaginertia fullinertia pos quat axisangle euler xyaxes zaxis", Read, "`import` reads \
        the mass and moments of inertia of the body, and the position and orientation of its centre of mass"),
    ("body/joint", "", Read, "the element becomes a revolute or prismatic joint; if a body has several joints, \
        `import` adds massless bodies between the joints"),
    ("body/joint", "name class type pos axis", Read, "`import` reads the name, class, type (`hinge` or `slide`), \
        position and axis of the joint, and rejects other types"),
    ("body/joint", "range limited", Read, "the range becomes two rigid stops"),
    ("body/joint", "stiffness springref damping", Read, "the attributes become a spring with a damper; `import` \
        rejects coefficients of higher order"),
    ("body/joint", "ref", Read, "`import` reads the angle or position of the joint in the file; ranges, springs and \
        control signals of the joint refer to this value"),
    ("body/joint", "armature frictionloss", Read, "`import` reads the rotor inertia and the constant friction of the \
        joint"),
    ("body/joint", "springdamper springyield", Rejected("0"), "`import` does not support this attribute: write \
        `stiffness` and `damping` instead"),
    ("body/joint", "margin solimpfriction solimplimit solreffriction solreflimit", LeftOut, SOFT),
    ("body/joint", "actuatorfrclimited actuatorfrcrange", LeftOut, DRIVE),
    ("body/joint", "actuatorgravcomp group user", NoEffect, LOOK),
    ("body/freejoint", "", Rejected(""), "a free body is not part of a mechanism: remove this element"),
    ("body/geom", "", Read, "`import` computes the mass of the body from its geoms, if the body has no `inertial`"),
    ("body/geom", "class type size fromto pos quat axisangle euler xyaxes zaxis mass density group", Read, "from \
        these attributes, `import` computes mass, centre and moment of inertia of a `sphere`, `capsule`, `cylinder`, \
        `box` or `ellipsoid`"),
    ("body/geom", "mesh", Read, "a mesh in a body without `inertial` is an error, because the mass of the mesh is \
        unknown"),
    ("body/geom", "shellinertia", Read, "the attribute is an error if `import` computes the mass of the body from the \
        geom"),
    ("body/geom", "fluidcoef fluidshape", LeftOut, "an imported mechanism has no surrounding medium"),
    ("body/geom", "contype conaffinity", Read, "if both attributes are 0, the note of `import` about contacts does not \
        list the geom"),
    ("body/geom", "adhesion condim friction gap margin priority solimp solmix solref surfacevel", NoEffect, TOUCH),
    ("body/geom", "name castshadow fitscale hfield material rgba user", NoEffect, LOOK),
    ("body/site", "", Read, "the site becomes a marker, if the body of the site moves"),
    ("body/site", "name class pos quat axisangle euler xyaxes zaxis fromto", Read, "`import` reads the name, \
        position and orientation"),
    ("body/site", "group material mesh rgba size type user", NoEffect, LOOK),
    ("body/camera body/light", "", NoEffect, LOOK),

    ("mujoco/equality", "", Read, "`import` reads the connections and couplings in this element"),
    ("equality/connect", "", Read, "the element becomes a revolute joint, if its bodies move in one plane"),
    ("equality/connect", "name class active body1 body2 anchor site1 site2", Read, "`import` reads the ends of the \
        joint; the two sites can be apart in the file, because `import` assembles the mechanism"),
    ("equality/weld", "", Read, "`import` combines the two bodies into one rigid body"),
    ("equality/weld", "class active body1 body2 anchor relpose site1 site2 torquescale", Read, "`import` reads the \
        two welded bodies, which must already be in the welded position in the file"),
    ("equality/joint", "", Read, "the element becomes a coupling by gears or a rack; `import` rejects two joints \
        without a common body"),
    ("equality/joint", "class active joint1 joint2 polycoef", Read, "`import` reads the coupled joints, the offset \
        and the ratio, and rejects a variable ratio"),
    ("equality/weld equality/joint", "name", NoEffect, LOOK),
    ("equality/*", "solimp solref", LeftOut, SOFT),
    ("equality/tendon equality/flex equality/flexstrain equality/flexvert equality/distance", "", Rejected(""),
        "`import` supports only the equalities `connect`, `weld` and `joint`: remove this equality"),

    ("mujoco/tendon", "", Read, "`import` reads the tendons in this element"),
    ("tendon/spatial", "", Read, "the tendon becomes a spring, a drive and limits between two points; `import` \
        rejects tendons over other sites, geoms or pulleys"),
    ("tendon/spatial", "name class stiffness damping springlength range limited armature frictionloss", Read, "the \
        attributes have the same meaning as for `body/joint`; `springlength` is the free length of the spring; a \
        tendon with friction is rejected"),
    ("tendon/spatial", "springyield", Rejected("0"), "springs of a definition cannot yield: set `springyield` to 0"),
    ("tendon/spatial", "margin solimpfriction solimplimit solreffriction solreflimit", LeftOut, SOFT),
    ("tendon/spatial", "actuatorfrclimited actuatorfrcrange", LeftOut, DRIVE),
    ("tendon/spatial", "group material rgba user width", NoEffect, LOOK),
    ("spatial/site", "", Read, "the site is an end of the tendon"),
    ("spatial/site", "site", Read, "`import` reads the name of the site"),
    ("spatial/geom spatial/pulley", "", Rejected(""), "`import` supports only tendons between two sites: remove this \
        element"),
    ("tendon/fixed", "", Rejected(""), "a tendon that couples several joints is not supported: couple the joints by \
        an equality, or let drives act on the joints"),

    ("mujoco/actuator", "", Read, "`import` reads the drives in this element"),
    ("actuator/general actuator/motor actuator/position actuator/velocity actuator/intvelocity actuator/damper \
        actuator/cylinder actuator/adhesion",
        "", Read, "the element becomes a drive of a joint or a tendon"),
    ("actuator/general", "biastype biasprm gaintype gainprm", Read, "`import` reads the gains of a controller and \
        the force of the drive at the start, and rejects a gain that depends on position or speed"),
    ("actuator/position actuator/intvelocity", "kp kv dampratio", Read, "`import` reads the gains of a controller, \
        and rejects `dampratio`"),
    ("actuator/velocity", "kv", Read, "`import` reads the speed gain of a controller"),
    ("actuator/general actuator/position actuator/velocity actuator/intvelocity actuator/cylinder", "forcelimited \
        forcerange", Read, "`import` reads the limits of the force of a controller"),
    ("actuator/position actuator/velocity", "gainprm", Read, "the attribute is the default of `kp` or `kv`, if the \
        default class `general` contains the attribute"),
    ("actuator/damper", "kv", Read, "the element becomes a drive whose force is 0 at the start, because a damper \
        exerts no force at the control signal 0"),
    ("actuator/cylinder", "area diameter bias", Read, "`import` reads the gains of a controller, the force of the \
        drive at the start, and the factor of the control signal"),
    ("actuator/*", "class joint jointinparent tendon gear damping armature", Read, "`import` reads the joint or \
        tendon on which the drive acts, the gear ratio, and the damping and inertia of the motor"),
    ("actuator/*", "actdim actearly actlimited actrange ctrllimited ctrlrange delay dynprm dyntype ffrange \
        forcelimited forcerange gain imax inheritrange posrange slewmax timeconst velrange", LeftOut, DRIVE),
    ("actuator/*", "body cranklength cranksite refsite site slidersite", LeftOut, "a drive of the definition acts \
        only on a joint or between two points"),
    ("actuator/*", "group input interp lengthrange name nsample user", NoEffect, LOOK),
    ("actuator/orientation actuator/pid actuator/muscle actuator/dcmotor actuator/plugin", "", Rejected(""), "the \
        control law is not supported: replace the actuator by an element `motor`, and let the simulation tool \
        compute the force"),
];

/// Message about contact between geoms of two bodies, unless one body carries the other.
pub fn contact(root: &Element) -> Option<String> {
    let is_off = |flag: &Element| flag.is("contact", "disable") || flag.is("constraint", "disable");
    if root.all("option").flat_map(|option| option.all("flag")).filter(|flag| is_off(flag)).count() > 0 {
        return None;
    }
    let mut geoms: Vec<(usize, usize, &Element)> = Vec::new();
    let mut count = 0;
    root.all("worldbody").for_each(|world| collect(world, (0, 0), &mut count, &mut geoms));
    let pairs = geoms.iter().enumerate().flat_map(|(at, one)| geoms[at + 1..].iter().map(move |other| (one, other)));
    let mut apart = pairs
        .filter(|((a, of_a, _), (b, of_b, _))| a != b && (*of_a != *b || *of_a == 0) && (*of_b != *a || *of_b == 0));
    let ((.., first), (.., other)) = apart.next()?;
    Some(format!(
        "contact between geoms, such as {} and {}, is left out: bodies of the imported mechanism can pass through each \
         other; add stops that end the travel",
        first.at(),
        other.at()
    ))
}

/// Geoms that may contact others, with their body and its parent.
fn collect<'a>(
    node: &'a Element,
    (own, parent): (usize, usize),
    count: &mut usize,
    geoms: &mut Vec<(usize, usize, &'a Element)>,
) {
    for inner in &node.children {
        match inner.tag.as_str() {
            "geom" if ["contype", "conaffinity"].iter().any(|key| inner.get(key) != Some("0")) => {
                geoms.push((own, parent, inner));
            }
            "frame" => collect(inner, (own, parent), count, geoms),
            "body" => {
                *count += 1;
                collect(inner, (*count, own), count, geoms);
            }
            _ => {}
        }
    }
}
