//! The connections and values of a system, by the variables of its FMUs.
//!
//! In: a system from its file, the models of its FMUs. Out: pairs of an output and an input, values in SI units, all
//! faults with the paths of their keys, warnings. The module must not know how a system is written.

use super::System;
use crate::start_values::{apply_all, find};
use crate::xml::ssv;
use anyhow::{Context, Result, anyhow, bail};
use linkage_fmu::component::Component;
use linkage_fmu::format::{DefinitionError, Faults};
use linkage_fmu::variables::{Causality, Interface, Member, Reference, Terminal, Unit, Value, Variable, nearest};
use std::collections::{BTreeMap, BTreeSet};

/// An FMU of the system by its index, and one of its variables.
pub type End = (usize, Reference);

/// Connections and values of a system.
#[derive(Debug, Default)]
pub struct Connected {
    names: Vec<String>,
    /// Output and input.
    pub connections: Vec<[End; 2]>,
    /// Values of each FMU, in the order of its variables.
    pub values: Vec<Vec<(Reference, Value)>>,
    /// Additional variables that are shown.
    shown: Vec<End>,
}

impl Connected {
    /// The connections and values of a system for these models, in the order of its FMUs.
    pub fn new(system: &System, models: &[&Component], faults: &mut Faults) -> Self {
        let stated = &system.definition;
        let names = stated.fmus.names().into_iter().map(str::to_owned).collect();
        let mut own = Self { names, ..Self::default() };
        let mut keep = |path: String, done: Result<()>| {
            if let Err(error) = done {
                faults.push(DefinitionError::key(path, format_args!("{error:#}")));
            }
        };
        for (name, model) in own.names.clone().iter().zip(models) {
            let values = own.read_values(system, name, model, &mut keep);
            own.values.push(values);
        }
        for (index, pair) in stated.terminals.iter().enumerate() {
            keep(format!("terminals[{index}]"), own.join(pair, models));
        }
        for (index, pair) in stated.connections.iter().enumerate() {
            keep(format!("connections[{index}]"), own.connect(pair, models));
        }
        for (index, name) in stated.connectors.iter().enumerate() {
            let end = own.end(name, models).map(|end| own.shown.push(end));
            keep(format!("connectors[{index}]"), end);
        }
        own
    }

    /// Values of an FMU: those of its parameter set, replaced by those of the system file. The model checks all of
    /// them.
    fn read_values(
        &self,
        system: &System,
        name: &str,
        model: &Component,
        keep: &mut impl FnMut(String, Result<()>),
    ) -> Vec<(Reference, Value)> {
        let path = format!("fmus.{name}");
        let Some(fmu) = system.definition.fmus.get(name) else { return Vec::new() };
        let mut values = BTreeMap::new();
        if let Some(file) = &fmu.parameters {
            let read = ssv::read(&system.path_of(file), model.interface());
            keep(format!("{path}.parameters"), read.map(|all| values.extend(all)));
        }
        for (variable, value) in fmu.values.iter() {
            let mut set = || {
                let reference = find(model.interface(), variable)?;
                let value = value.value(&model.interface().list()[reference as usize])?;
                values.insert(reference, value);
                Ok(())
            };
            keep(format!("{path}.values.{variable}"), set());
        }
        let values: Vec<_> = values.into_iter().collect();
        keep(format!("{path}.values"), apply_all(&mut (*model).clone(), values.clone()));
        values
    }

    /// Part and rest of a name such as `gear.crank.angle`.
    fn split<'n>(&self, name: &'n str) -> Result<(usize, &'n str)> {
        let (part, rest) = name.split_once('.').with_context(|| {
            format!("\"{}\" names no FMU; write the name of the FMU, a dot and the name", name.escape_debug())
        })?;
        let index = self.names.iter().position(|own| own == part).with_context(|| {
            let near = nearest(self.names.iter().map(String::as_str), part).join(", ");
            format!("the system has no FMU \"{}\": the most similar names are {near}", part.escape_debug())
        })?;
        Ok((index, rest))
    }

    fn end(&self, name: &str, models: &[&Component]) -> Result<End> {
        let (part, variable) = self.split(name)?;
        let reference = find(models[part].interface(), variable).context(self.names[part].clone())?;
        Ok((part, reference))
    }

    /// Connect an output with an input.
    fn connect(&mut self, pair: &[String], models: &[&Component]) -> Result<()> {
        let [output, input] = pair else {
            bail!("the entry has {} names; write two names: an output and an input", pair.len())
        };
        let ends = [self.end(output, models)?, self.end(input, models)?];
        self.add(ends, [output, input], models)
    }

    fn add(&mut self, ends: [End; 2], names: [&str; 2], models: &[&Component]) -> Result<()> {
        let [output, input] = ends.map(|end| variable(end, models));
        let [first, second] = names;
        let unit = |variable: &Variable| variable.unit.map_or(variable.kind.word(), Unit::name);
        match (output.causality, input.causality) {
            (Causality::Output, Causality::Input) => {}
            (Causality::Input, Causality::Output) => {
                bail!("{first} is an input and {second} is an output; exchange the two names")
            }
            (one, other) => bail!(
                "{first} is a variable of causality {}, and {second} of causality {}; connect an output with an input",
                one.word().to_lowercase(),
                other.word().to_lowercase()
            ),
        }
        if (output.kind, output.unit) != (input.kind, input.unit) {
            bail!(
                "{first} has the unit {}, but {second} has the unit {}; connect variables of the same unit",
                unit(output),
                unit(input)
            );
        }
        if let Some([(part, other), _]) = self.connections.iter().find(|[_, target]| *target == ends[1]) {
            let other = &models[*part].interface().list()[*other as usize].name;
            bail!(
                "{second} already has a connection with {}.{other}; remove one of the two connections",
                self.names[*part]
            );
        }
        self.connections.push(ends);
        Ok(())
    }

    /// Connect all variables that two terminals have in common.
    fn join(&mut self, pair: &[String], models: &[&Component]) -> Result<()> {
        let [first, second] = pair else {
            bail!("the entry has {} names; write two names: the terminals of two FMUs", pair.len())
        };
        let [(one, a), (other, b)] = [self.terminal(first, models)?, self.terminal(second, models)?];
        if a.kind != b.kind {
            bail!(
                "{first} is a drive along the quantity {}, but {second} along the quantity {}; connect drives along \
                 the same quantity",
                a.kind,
                b.kind
            );
        }
        let pairs = a.members.iter().filter_map(|member| {
            let same = |other: &&Member| other.name == member.name;
            Some([(one, member.variable), (other, b.members.iter().find(same)?.variable)])
        });
        for ends in pairs.collect::<Vec<_>>() {
            let names = ends.map(|end| format!("{}.{}", self.names[end.0], variable(end, models).name));
            let [own, far] = ends.map(|end| variable(end, models).causality);
            match (own, far) {
                (Causality::Input, Causality::Output) => {
                    self.add([ends[1], ends[0]], [&names[1], &names[0]], models)?;
                }
                (Causality::Input, Causality::Input) => bail!(
                    "{} and {} are both inputs; connect the drive of a mechanism with an actuator or a cylinder",
                    names[0],
                    names[1]
                ),
                _ => self.add(ends, [&names[0], &names[1]], models)?,
            }
        }
        Ok(())
    }

    /// The FMU and the terminal with a name such as `gear.actuator`.
    fn terminal(&self, name: &str, models: &[&Component]) -> Result<(usize, Terminal)> {
        let (part, rest) = self.split(name)?;
        let terminals = models[part].terminals();
        let names = terminals.iter().map(|terminal| terminal.name.as_str()).collect::<Vec<_>>().join(", ");
        let found = terminals.iter().find(|terminal| terminal.name == rest).cloned();
        let found = found.ok_or_else(|| match names.as_str() {
            "" => anyhow!("{} has no drive and no cylinder, so that it has no terminal", self.names[part]),
            names => {
                anyhow!("{} has no terminal \"{}\": its terminals are {names}", self.names[part], rest.escape_debug())
            }
        })?;
        Ok((part, found))
    }

    /// Connected, shown and set variables of each FMU, without duplicates, in the order of the FMU.
    pub fn connectors<'m>(&self, models: &[&'m Component]) -> Vec<Vec<&'m Variable>> {
        let mut all = vec![BTreeSet::new(); models.len()];
        for (part, reference) in self.connections.iter().flatten().chain(&self.shown) {
            all[*part].insert(*reference);
        }
        for (part, values) in all.iter_mut().zip(&self.values) {
            part.extend(values.iter().map(|(reference, _)| *reference));
        }
        let variables = |(part, references): (usize, BTreeSet<Reference>)| {
            references.into_iter().map(|reference| variable((part, reference), models)).collect()
        };
        all.into_iter().enumerate().map(variables).collect()
    }

    /// Warnings: an FMU without a connection, a loop of values that depend on each other directly.
    pub fn warnings(&self, models: &[&Component]) -> Vec<String> {
        let is_alone = |part: &usize| self.connections.iter().flatten().all(|(other, _)| other != part);
        let alone = (0..models.len()).filter(|part| models.len() > 1 && is_alone(part));
        let mut warnings: Vec<String> =
            alone.map(|part| format!("fmus.{}: this FMU has no connection", self.names[part])).collect();
        if let Some(ends) = self.algebraic_loop(models) {
            let names: Vec<_> =
                ends.iter().map(|end| format!("{}.{}", self.names[end.0], variable(*end, models).name)).collect();
            warnings.push(format!(
                "connections: {} depend on each other at the same time (algebraic loop); simulation tools use values \
                 of the step before, or iterate",
                names.join(", ")
            ));
        }
        warnings
    }

    /// Outputs in a loop: each depends on the next, and the last on the first. None if there is no loop.
    fn algebraic_loop(&self, models: &[&Component]) -> Option<Vec<End>> {
        let mut done = BTreeSet::new();
        self.connections.iter().find_map(|[output, _]| self.returns(*output, models, &mut Vec::new(), &mut done))
    }

    /// The part of `path` that leads back to this output, through the outputs on which it depends.
    fn returns(
        &self,
        output: End,
        models: &[&Component],
        path: &mut Vec<End>,
        done: &mut BTreeSet<End>,
    ) -> Option<Vec<End>> {
        if let Some(start) = path.iter().position(|end| *end == output) {
            return Some(path[start..].to_vec());
        }
        if !done.insert(output) {
            return None;
        }
        path.push(output);
        let needed =
            |[_, input]: &&[End; 2]| input.0 == output.0 && variable(output, models).dependencies.contains(&input.1);
        let found =
            self.connections.iter().filter(needed).find_map(|[next, _]| self.returns(*next, models, path, done));
        path.pop();
        found
    }
}

fn variable<'m>((part, reference): End, models: &[&'m Component]) -> &'m Variable {
    let interface: &'m Interface = models[part].interface();
    &interface.list()[reference as usize]
}
