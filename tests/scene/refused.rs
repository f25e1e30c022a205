//! Keys that are refused for what other keys say.

use flyer_mpm::input;

use super::{mentions, mentions_all, refused, with};

#[test]
fn domains_that_do_not_fit() {
    let edit = |set: &str, fragments: &[&str]| refused("flyer.json", &[set], fragments);
    edit("domain.upper=[-0.001]", &["domain.upper = [-0.001]", "lower < upper"]);
    edit("domain.cell_size=3e-5", &["domain.cell_size = 0.00003", "whole number of cells", "333"]);
    edit("domain.cell_size=1", &["domain.cell_size = 1", "nearest is 0.01 for 1 cells"]);
    edit("domain.cell_size=1e-300", &["domain.cell_size = 1e-300", "at most 1e15"]);
    edit("domain.cell_size=[1e-5, 1e-5]", &["domain.cell_size", "2 numbers", "1 number"]);
    edit("domain.patches=[0]", &["domain.patches[0] = 0", "at least 1"]);
    edit("domain.patches=[1001]", &["domain.patches = [1001]", "1 to 1000"]);
    edit("domain.patches=[2, 2]", &["domain.patches = [2,2]", "1 number"]);
    edit("domain.lower=[]", &["domain.lower = []", "allowed"]);
    edit("domain.upper=[0.009, 1]", &["domain.upper = [0.009,1.0]", "2 numbers", "1 number"]);
    let far = ["domain.lower=[1e9]", "domain.upper=[1.000000001e9]", "domain.cell_size=1e-3"];
    // the bodies are outside of this domain as well
    let message = with("flyer.json", &far).unwrap_err();
    mentions_all(&message, &["domain.cell_size = 0.001", "too small for doubles"]);
    let plane = ["domain.lower=[0, 0]", "domain.upper=[1, 1]"];
    let message = with("flyer.json", &plane).unwrap_err();
    mentions_all(
        &message,
        &["bodies.flyer.box.lower = [-0.0005]", "domain.lower has 2", "allowed: 2 numbers"],
    );
    edit("boundary={\"y_upper\": \"wall\"}", &["boundary.y_upper = \"wall\"", "a side along y"]);
    let stiff = ["method.shape=\"bspline_quadratic\"", "method.domain_limit=1"];
    refused("flyer.json", &stiff, &["method.domain_limit = 1", "no particle's domain deforms"]);
    let space = ["domain.lower=[0, 0, 0]", "domain.upper=[1, 1, 1]"];
    refused("flyer.json", &space, &["domain.lower", "allowed: one number or two"]);
}

#[test]
fn impacts_that_cannot_be_smoothed() {
    let smooth = "impact_smoothing=1";
    let fragments = ["impact_smoothing = 1", "no impact that it can smooth", "leave it out"];
    let alone = "reference=null";
    refused("flyer.json", &[smooth, alone, "bodies.target.velocity=[1000]"], &fragments);
    refused("flyer.json", &[smooth, alone, "bodies.target.box.lower=[0.001]"], &fragments);
    refused("flyer_2d.json", &[smooth], &fragments);
    refused("flyer.json", &["impact_smoothing=0"], &["impact_smoothing = 0", "above 0"]);
    with("flyer.json", &[smooth]).unwrap();
}

#[test]
fn bodies_that_do_not_fit() {
    let edit = |set: &str, fragments: &[&str]| refused("flyer.json", &[set], fragments);
    edit("bodies.flyer.box.lower=[-0.1]", &["bodies.flyer.box.lower = [-0.1]", "-0.001 to 0.009"]);
    edit("bodies.target.box.upper=[1]", &["bodies.target.box.upper = [1.0]", "-0.001 to 0.009"]);
    edit("bodies.flyer.box.upper=[1e-4]", &["bodies.target.box", "overlaps bodies.flyer.box"]);
    edit("bodies.flyer.box.upper=[-0.0007]", &["bodies.flyer.box.upper", "lower < upper"]);
    edit("bodies.flyer.name=target", &["bodies[1].name = \"target\"", "a name of its own"]);
    edit("bodies.flyer.name=\"\"", &["bodies[0].name = \"\"", "is empty"]);
    edit("bodies.flyer.name=\"a\\nb\"", &["bodies[0].name = \"a\\nb\"", "control character"]);
    edit("title=\"a\\u0007b\"", &["title = \"a\\u0007b\"", "control character"]);
    edit("bodies.flyer.velocity=[1, 2]", &["bodies.flyer.velocity = [1.0,2.0]", "1 number"]);
    edit("bodies.flyer.box.lower=[0, 0]", &["bodies.flyer.box.lower = [0.0,0.0]", "1 number"]);
    edit("bodies.flyer.particles_per_cell=[2, 2]", &["particles_per_cell = [2,2]", "1 number"]);
    edit("bodies.flyer.box.lower=[-1e-6]", &["bodies.flyer.box = {", "no particle"]);
    edit(
        "bodies.flyer.particles_per_cell=[18446744073709551615]",
        &["bodies.flyer.particles_per_cell = [18446744073709551615]", "at most 1e15"],
    );
    edit(
        "bodies.flyer.pressure=-1e11",
        &["bodies.flyer.pressure", "allowed: at least -35363711224"],
    );
    let sets = ["bodies.right.pressure=-0.1"];
    refused("sod.json", &sets, &["bodies.right.pressure = -0.1", "at least 0"]);
    // rounding is no overlap
    assert!(with("flyer.json", &["bodies.flyer.box.upper=[1e-15]"]).is_ok());
}

#[test]
fn memory_is_reported_before_it_is_taken() {
    let sets = ["bodies.flyer.particles_per_cell=[1000000000]"];
    let checked = with("flyer.json", &sets).unwrap();
    assert_eq!(checked.particles, 50_000_001_600);
    let error = checked.check_memory(Some(1 << 33)).unwrap_err().to_string();
    mentions(
        &error,
        &["flyer.json", "50000001600 particles", "TiB", "allowed: 8.0 GiB", "cell_size"],
    );
    assert!(checked.check_memory(None).is_ok());
    let small = with("flyer.json", &[]).unwrap();
    assert!(small.check_memory(input::available_memory()).is_ok());
    assert!(small.check_memory(Some(1000)).is_err());
}

#[test]
fn impacts_beyond_the_hugoniot() {
    let fast = ["bodies.flyer.velocity=[200000]"];
    refused(
        "flyer.json",
        &fast,
        &["bodies.flyer.velocity = [200000.0]", "target at 200000 m/s", "0.95/s", "at most 1"],
    );
    let fast = ["bodies.flyer.velocity=[0]", "bodies.target.velocity=[-200000]"];
    refused("flyer.json", &fast, &["bodies.target.velocity = [-200000.0]", "impact on flyer"]);
    let fast = ["bodies.slab.velocity=[-80000]"];
    refused(
        "piston.json",
        &fast,
        &["bodies.slab.velocity = [-80000.0]", "boundary.x_lower at 80000 m/s", "at most 76426"],
    );
    assert!(with("piston.json", &["bodies.slab.velocity=[-76000]"]).is_ok());
    assert!(with("sod.json", &["bodies.left.velocity=[1e4]"]).is_ok(), "a gas has no such limit");
}

#[test]
fn options_that_cannot_go_together_are_named() {
    let edit = |set: &str, fragments: &[&str]| refused("flyer.json", &[set], fragments);
    let leapfrog = "method.stepping = \"leapfrog\"";
    for update in ["first", "modified_last"] {
        let value = format!("method.stress_update = \"{update}\"");
        let midpoint = "method.stepping = \"midpoint\"";
        edit(&format!("method.stress_update={update}"), &[&value, midpoint, "allowed: \"last\""]);
    }
    edit("method.stepping=leapfrog", &["method.energy = \"compatible\"", leapfrog, "textbook"]);
    for (set, fragments) in [
        ("method.filter_heat=true", ["method.filter_heat = true", "false"]),
        ("method.edge_mask=0.3", ["method.edge_mask = 0.3", "leave it out"]),
        (
            "method.heat_spreading={\"steps\": 10}",
            ["method.heat_spreading = {\"steps\":10.0}", "leave it out"],
        ),
        (
            "method.pressure_relaxation={\"rate\": 0.2, \"interval\": 5}",
            ["method.pressure_relaxation = {", "leave it out"],
        ),
    ] {
        refused("flyer_uintah.json", &[set], &[fragments[0], leapfrog, "allowed: ", fragments[1]]);
    }
    for transfer in ["flip", "apic"] {
        let sets = [&format!("method.transfer={transfer}"), "method.energy=textbook"];
        let value = format!("method.transfer = \"{transfer}\"");
        refused("flyer.json", &sets, &["method.filter_heat = true", &value, "{\"xpic\": m}"]);
    }
    edit("method.transfer=apic", &["method.energy = \"compatible\"", "method.transfer = \"apic\""]);
    let sets =
        ["method.heat_spreading.steps=1", "method.energy=textbook", "method.filter_heat=false"];
    let fragments = ["method.heat_spreading = {\"steps\":1.0}", "method.energy = \"textbook\""];
    refused("flyer.json", &sets, &fragments);
    let sets = ["method.heat_spreading.steps=1", "method.transfer=apic", "method.energy=textbook"];
    let off =
        ["method.filter_heat=false", "method.edge_mask=null", "method.pressure_relaxation=null"];
    let fragments = ["method.heat_spreading = {\"steps\":1.0}", "method.transfer = \"apic\""];
    refused("flyer.json", &[&sets[..], &off].concat(), &fragments);
    edit("method.heat_spreading.steps=0.5", &["method.heat_spreading.steps = 0.5", "at least 1"]);
    edit("method.transfer=pic", &["method.edge_mask = 0.4", "method.transfer = \"pic\""]);
    let lumping = "method.mass_lumping=0.1";
    for (set, other) in [
        ("method.transfer={\"fmpm\": 1}", "method.transfer = {\"fmpm\":1}"),
        ("method.flux_limiter={\"neighbours\": 1}", "method.flux_limiter = {\"neighbours\":1}"),
    ] {
        refused("flyer.json", &[lumping, set], &["method.mass_lumping = 0.1", other, "leave"]);
    }
    refused(
        "flyer_uintah.json",
        &["artificial_viscosity.limited=both"],
        &["artificial_viscosity.limited = \"both\"", "artificial_viscosity.limiter"],
    );
    assert!(with("flyer.json", &["artificial_viscosity.limited=both"]).is_ok());
}

#[test]
fn what_the_total_lagrangian_frame_cannot_do() {
    let total = "method.frame=total_lagrangian";
    let name = "method.frame = \"total_lagrangian\"";
    for (set, value) in [
        ("method.volume_relaxation=0.1", "method.volume_relaxation = 0.1"),
        ("boundary={\"x_upper\": \"outflow\"}", "boundary.x_upper = \"outflow\""),
        ("bodies.flyer.box.upper=[-1e-5]", "bodies[1] = \"target\""),
    ] {
        refused("flyer.json", &[total, set], &[value, name, "updated_lagrangian"]);
    }
    refused("flyer_2d.json", &[total], &["method.domain_limit = 1", name]);
    let slides = "contact={\"type\": \"frictionless\"}";
    let sets = [total, "method.domain_limit=null", slides];
    refused("flyer_2d.json", &sets, &["contact = {", name, "stick"]);
    refused("flyer.json", &["method.frame=lagrangian"], &["method.frame", "total_lagrangian"]);
    assert!(with("soft_flyer.json", &[total]).is_ok());
}

#[test]
fn contact_that_says_nothing_or_too_much() {
    let edit = |set: &str, fragments: &[&str]| refused("soft_flyer.json", &[set], fragments);
    edit("contact.type=glue", &["contact", "glue", "frictionless"]);
    edit("contact={\"type\": \"friction\"}", &["contact", "coefficient"]);
    let negative = "contact={\"type\": \"friction\", \"coefficient\": -0.1}";
    edit(negative, &["contact.coefficient = -0.1", "at least 0"]);
    edit("contact={\"type\": \"stick\", \"coefficient\": 0.1}", &["contact", "coefficient"]);
    let both = "contact={\"type\": \"frictionless\", \"coefficient\": 0.1}";
    edit(both, &["contact", "coefficient"]);
    let normals = "contact={\"type\": \"frictionless\", \"normals\": \"logistic_regression\"}";
    edit(normals, &["contact.normals = \"logistic_regression\"", "two dimensions"]);
    edit("contact.normals=volume", &["contact", "volume"]);
    let warned = |name: &str, sets: &[&str]| with(name, sets).unwrap().warnings.join("; ");
    let friction = "contact={\"type\": \"friction\", \"coefficient\": 0.1}";
    mentions(&warned("soft_flyer.json", &[friction]), &["contact.type", "nothing slides"]);
    let sets = ["contact={\"type\": \"frictionless\"}"];
    mentions(&warned("piston.json", &sets), &["one body"]);
    // a softer flyer is held together without contact alone
    mentions(&warned("soft_flyer.json", &["contact={\"type\": \"stick\"}"]), &["would separate"]);
    assert_eq!(warned("soft_flyer.json", &[]), "");
}

#[test]
fn sides_that_cannot_face_each_other() {
    let pair = |lower: &str, upper: &str| {
        let sets = [format!("boundary.x_lower={lower}"), format!("boundary.x_upper={upper}")];
        with("flyer.json", &[&sets[0], &sets[1]])
    };
    let message = |lower: &str, upper: &str, fragments: &[&str]| {
        mentions(&pair(lower, upper).unwrap_err(), fragments);
    };
    let piston = "{\"velocity\": 10.0}";
    message("periodic", "free", &["boundary.x_lower = \"periodic\"", "x_upper = \"free\"", "both"]);
    message("wall", "periodic", &["boundary.x_lower = \"wall\"", "x_upper = \"periodic\""]);
    // the one that lacks its partner is named first
    message(
        "symmetry",
        "periodic",
        &["json: boundary.x_upper = \"periodic\": cannot stand opposite"],
    );
    message(piston, "wall", &["boundary.x_lower = {\"velocity\":10.0}", "x_upper = \"wall\""]);
    message("symmetry", piston, &["boundary.x_lower = \"symmetry\"", "the same velocity"]);
    for (lower, upper) in [
        ("periodic", "periodic"),
        (piston, piston),
        (piston, "free"),
        ("outflow", piston),
        ("wall", "{\"velocity\": 0}"),
    ] {
        assert!(pair(lower, upper).is_ok(), "{lower} {upper}");
    }
}

#[test]
fn times_of_outputs() {
    let edit = |set: &str, fragments: &[&str]| refused("flyer.json", &[set], fragments);
    edit(
        "output.profiles.times=[2e-7, 2e-6]",
        &["output.profiles.times[1] = 2e-6", "beyond time.end = 1e-6", "allowed"],
    );
    edit("output.profiles.times=[2e-7, 2e-7]", &["output.profiles.times[1]", "increasing"]);
    edit("output.profiles.times=[-1]", &["output.profiles.times[0] = -1", "at least 0"]);
}

#[test]
fn tracers() {
    let edit = |set: &str, fragments: &[&str]| {
        let sets =
            ["output.histories.tracers=[{\"name\":\"a\",\"body\":\"target\",\"at\":[1e-3]}]", set];
        refused("flyer.json", &sets, fragments);
    };
    edit("output.histories.tracers.a.name=\"a b\"", &["tracers[0].name = \"a b\"", "letters"]);
    edit("output.histories.tracers.a.body=tarjet", &["tracers.a.body", "did you mean target?"]);
    edit("output.histories.tracers.a.at=[9]", &["tracers.a.at = [9.0]", "0 to 0.008"]);
    edit("output.histories.tracers.a.at=[1, 2]", &["tracers.a.at = [1.0,2.0]", "1 number"]);
    let twice = "output.histories.tracers=[{\"name\":\"a\",\"body\":\"target\",\"at\":[1e-3]},\
                 {\"name\":\"a\",\"body\":\"flyer\",\"at\":[-1e-4]}]";
    refused("flyer.json", &[twice], &["tracers[1].name = \"a\"", "a name of its own"]);
}

#[test]
fn references_that_do_not_hold() {
    let edit = |sets: &[&str], fragments: &[&str]| refused("flyer.json", sets, fragments);
    edit(
        &["reference.flyer_impact.flyer=target"],
        &["reference.flyer_impact.target = \"target\"", "the same body", "two bodies"],
    );
    edit(&["bodies.flyer.velocity=[-1]"], &["bodies.flyer.velocity = [-1.0]", "approach"]);
    edit(&["bodies.flyer.velocity=[0]"], &["bodies.flyer.velocity = [0.0]", "above 0"]);
    edit(
        &["bodies.flyer.box.upper=[-1e-4]"],
        &["reference.flyer_impact.flyer = \"flyer\"", "a gap of 1e-4 m", "boxes touch"],
    );
    edit(&["bodies.flyer.pressure=1e5"], &["bodies.flyer.pressure = 100000.0", "allowed: 0"]);
    edit(
        &["materials.copper.eos={\"type\": \"ideal_gas\", \"gamma\": 1.4}"],
        &["reference.flyer_impact.flyer", "materials.copper.eos.type = \"ideal_gas\""],
    );
    let sod = |sets: &[&str], fragments: &[&str]| refused("sod.json", sets, fragments);
    sod(
        &["reference.riemann.left=right", "reference.riemann.right=left"],
        &["reference.riemann.left = \"right\"", "lies above", "the body below"],
    );
    sod(&["bodies.left.pressure=0"], &["bodies.left.pressure = 0", "above 0"]);
    sod(&["bodies.right.velocity=[50]"], &["bodies.right.velocity = [50.0]", "vacuum"]);
    refused(
        "piston.json",
        &["boundary.x_lower=free"],
        &["reference.wall_impact.body = \"slab\"", "touches no wall", "\"symmetry\""],
    );
    refused("piston.json", &["bodies.slab.velocity=[1]"], &["reference.wall_impact.body"]);
    refused("piston.json", &["bodies.slab.box.lower=[1e-4]"], &["touches no wall"]);
    refused("piston.json", &["reference.wall_impact.body=slap"], &["did you mean slab?"]);
    // a target that stands below its flyer
    let mirrored = [
        "domain.lower=[-0.009]",
        "domain.upper=[0.001]",
        "bodies.flyer.box={\"lower\": [0], \"upper\": [0.0005]}",
        "bodies.flyer.velocity=[-1000]",
        "bodies.target.box={\"lower\": [-0.008], \"upper\": [0]}",
    ];
    assert!(with("flyer.json", &mirrored).is_ok());
}
