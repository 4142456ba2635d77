//! The retraction of the landing gear from Rust: `cargo run --release --example retraction`.
use linkage_fmu::simulation::Simulation;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let definition = include_str!("../modelDescription/LandingGearRetraction/resources/mechanism.json");
    let mut gear = Simulation::open(definition)?;
    gear.set("actuator.force", 30e3)?;
    gear.set("friction.enabled", true)?;
    gear.initialize()?;
    println!("time [s]  crank angle [deg]  reaction in joint 1 [N]");
    while !gear.boolean("retracted")? && gear.time() < 1.0 {
        gear.step(0.01)?;
        let (angle, reaction) = (gear.get("crank.angle")?, gear.get("joint1.force")?);
        println!("{:8.2}  {:17.2}  {reaction:23.1}", gear.time(), angle.to_degrees());
    }
    Ok(())
}
