//! Steps on one thread, compiled only once, here: a test that calls `Simulation::step` compiles the whole step
//! again.

/// A simulation that takes steps.
pub trait Steps {
    /// The reason why a step fails.
    type Error;

    /// Takes one step on one thread.
    fn take_step(&mut self) -> Result<(), Self::Error>;
}

macro_rules! steps {
    ($muslin:ident) => {
        impl Steps for $muslin::simulation::Simulation {
            type Error = $muslin::simulation::StepError;

            fn take_step(&mut self) -> Result<(), Self::Error> {
                self.step(&$muslin::dispatch::Serial)
            }
        }
    };
}

steps!(muslin_core);
steps!(muslin_core_f64);
