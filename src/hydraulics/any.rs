//! A hydraulic model of any kind behind one trait: the code of a kind is reached through the model alone, so that a
//! library that makes no model of this kind is without this code.
//!
//! In: a model. Out: its answers, and its snapshots. It must not know any law.
use super::error::HydraulicsError;
use super::model::{Model, Snapshot};
use super::{definition, network};
use foundation::codec::writer::Writer;
use foundation::format::{About, Experiment};
use foundation::inspection::Finding;
use foundation::integrator::Statistics;
use foundation::variables::{Interface, Reference, Terminal};
use std::any::Any;
use std::fmt::Debug;

/// The methods that all hydraulic models have, declared once: the trait, and the trait of each model by its method of
/// the same name.
macro_rules! methods {
    ($(fn $name:ident($this:ident: $receiver:ty $(, $argument:ident: $type:ty)*) $(-> $answer:ty)?;)*) => {
        /// What a hydraulic model answers; each method is that of [`Model`].
        #[allow(missing_docs, clippy::missing_errors_doc, reason = "the model's own methods have the texts")]
        pub trait AnyModel: Debug + Send + Sync {
            fn definition_file(&self) -> &'static str;
            fn interface(&self) -> &Interface;
            fn duplicate(&self) -> Box<dyn AnyModel>;
            fn snapshot(&self) -> Box<dyn AnySnapshot>;
            fn snapshot_into(&self, snapshot: &mut Box<dyn AnySnapshot>);
            fn restore(&mut self, snapshot: &dyn AnySnapshot) -> Result<bool, HydraulicsError>;
            fn read_snapshot(&self, bytes: &[u8]) -> Result<Box<dyn AnySnapshot>, HydraulicsError>;
            $(fn $name($this: $receiver $(, $argument: $type)*) $(-> $answer)?;)*
        }

        methods! {
            of Model, Snapshot, definition::FILE =>
            $(fn $name($this: $receiver $(, $argument: $type)*) $(-> $answer)?;)*
        }
        methods! {
            of network::Model, network::Snapshot, network::FILE =>
            $(fn $name($this: $receiver $(, $argument: $type)*) $(-> $answer)?;)*
        }
    };
    (of $model:ty, $snapshot:ty, $file:expr =>
        $(fn $name:ident($this:ident: $receiver:ty $(, $argument:ident: $type:ty)*) $(-> $answer:ty)?;)*) => {
        impl AnyModel for $model {
            fn definition_file(&self) -> &'static str {
                $file
            }

            fn interface(&self) -> &Interface {
                self.variables()
            }

            fn duplicate(&self) -> Box<dyn AnyModel> {
                Box::new(self.clone())
            }

            fn snapshot(&self) -> Box<dyn AnySnapshot> {
                Box::new(<$model>::snapshot(self))
            }

            fn snapshot_into(&self, snapshot: &mut Box<dyn AnySnapshot>) {
                match (snapshot.as_mut() as &mut dyn Any).downcast_mut::<$snapshot>() {
                    Some(own) => <$model>::snapshot_into(self, own),
                    None => *snapshot = AnyModel::snapshot(self),
                }
            }

            fn restore(&mut self, snapshot: &dyn AnySnapshot) -> Result<bool, HydraulicsError> {
                let own = (snapshot as &dyn Any).downcast_ref::<$snapshot>();
                own.map_or(Ok(false), |own| <$model>::restore(self, own).map(|()| true))
            }

            fn read_snapshot(&self, bytes: &[u8]) -> Result<Box<dyn AnySnapshot>, HydraulicsError> {
                Ok(Box::new(<$model>::read_snapshot(self, bytes)?))
            }

            $(fn $name($this: $receiver $(, $argument: $type)*) $(-> $answer)? {
                <$model>::$name($this $(, $argument)*)
            })*
        }
    };
}

type Done = Result<(), HydraulicsError>;

methods! {
    fn name(self: &Self) -> &str;
    fn about(self: &Self) -> &About;
    fn description(self: &Self) -> &str;
    fn experiment(self: &Self) -> Experiment;
    fn terminals(self: &Self) -> Vec<Terminal>;
    fn identity(self: &Self) -> [u64; 2];
    fn warnings(self: &Self) -> Vec<Finding>;
    fn initial_dependencies(self: &Self) -> Result<Option<Vec<Vec<Reference>>>, HydraulicsError>;
    fn real(self: &mut Self, reference: Reference) -> Result<f64, HydraulicsError>;
    fn boolean(self: &mut Self, reference: Reference) -> Result<bool, HydraulicsError>;
    fn item(self: &mut Self, reference: Reference) -> Result<usize, HydraulicsError>;
    fn check_real(self: &Self, reference: Reference, value: f64) -> Done;
    fn set_real(self: &mut Self, reference: Reference, value: f64) -> Done;
    fn take_real(self: &mut Self, reference: Reference, value: f64) -> Done;
    fn check_together(self: &Self, references: &[Reference], values: &[f64]) -> Done;
    fn check_boolean(self: &Self, reference: Reference, value: bool) -> Done;
    fn set_boolean(self: &mut Self, reference: Reference, value: bool) -> Done;
    fn check_text(self: &Self, reference: Reference, value: &str) -> Done;
    fn set_text(self: &mut Self, reference: Reference, value: &str) -> Done;
    fn tune(self: &mut Self, references: &[Reference], values: &[f64]) -> Done;
    fn output_derivative(self: &mut Self, reference: Reference, order: i32) -> Result<f64, HydraulicsError>;
    fn check_input_derivative(self: &Self, reference: Reference, order: i32, value: f64) -> Done;
    fn set_input_derivative(self: &mut Self, reference: Reference, order: i32, value: f64) -> Done;
    fn directional_derivative(
        self: &mut Self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        report: &mut dyn FnMut(usize, f64)
    ) -> Done;
    fn undefined(self: &mut Self, reference: Reference) -> Option<String>;
    fn undefined_derivative(self: &mut Self, reference: Reference) -> Option<String>;
    fn set_tolerance(self: &mut Self, tolerance: f64) -> Done;
    fn initialize(self: &mut Self) -> Done;
    fn step(self: &mut Self, h: f64) -> Done;
    fn has_events(self: &Self) -> bool;
    fn step_to_event(self: &mut Self, h: f64) -> Result<Option<f64>, HydraulicsError>;
    fn handle_event(self: &mut Self);
    fn take_event(self: &mut Self) -> Option<(f64, String)>;
    fn take_warning(self: &mut Self) -> Option<String>;
    fn reset(self: &mut Self);
    fn statistics(self: &Self) -> Statistics;
}

impl Clone for Box<dyn AnyModel> {
    fn clone(&self) -> Self {
        self.as_ref().duplicate()
    }
}

/// What a snapshot of a hydraulic model answers.
#[allow(missing_docs, clippy::missing_errors_doc, reason = "the snapshot's own methods have the texts")]
pub trait AnySnapshot: Any + Debug + Send + Sync {
    fn duplicate(&self) -> Box<dyn AnySnapshot>;
    fn has_motion(&self) -> bool;
    fn write_to(&self, out: &mut Writer) -> Result<(), HydraulicsError>;
}

macro_rules! any_snapshot {
    ($snapshot:ty) => {
        impl AnySnapshot for $snapshot {
            fn duplicate(&self) -> Box<dyn AnySnapshot> {
                Box::new(self.clone())
            }

            fn has_motion(&self) -> bool {
                <$snapshot>::has_motion(self)
            }

            fn write_to(&self, out: &mut Writer) -> Result<(), HydraulicsError> {
                <$snapshot>::write_to(self, out)
            }
        }
    };
}
any_snapshot!(Snapshot);
any_snapshot!(network::Snapshot);

impl Clone for Box<dyn AnySnapshot> {
    fn clone(&self) -> Self {
        self.as_ref().duplicate()
    }
}
