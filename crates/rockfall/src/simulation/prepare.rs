//! Compiling kernels before they are needed.

use crate::error::Result;
use crate::settings::BroadPhase;
use crate::simulation::Simulation;
#[cfg(not(target_family = "wasm"))]
use crate::simulation::engine;
use crate::step::schedule::{MEASURE_ORDER, Run, SORT_MEMORY};

impl Simulation {
    /// Compiles all that steps of the scene as it is will need, so that none has to wait for it: else a kernel is compiled before
    /// it runs for the first time, those that put memory in order in the middle of a run. Takes some tenths of a second, more where
    /// the device's driver has not seen the kernels before; nothing on the CPU. Objects of kinds that the scene did not have may
    /// need others.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when a kernel does not compile or the device is lost.
    #[cfg(not(target_family = "wasm"))]
    pub fn prepare(&mut self) -> Result<()> {
        let device = self.engine.waiter();
        engine::block_on(device, self.prepare_async())
    }

    /// [`Simulation::prepare`] without waiting for the device; the host is busy compiling all the same.
    ///
    /// # Errors
    /// As there.
    pub async fn prepare_async(&mut self) -> Result<()> {
        self.flush_async().await?;
        let (integrator, broad_phase) = (self.options.integrator, self.broad_phase_method());
        let stages = self.step_phases().iter().flat_map(|phase| phase.stages(integrator, broad_phase));
        let stages: Vec<Run> = stages.copied().collect();
        self.engine.prepare(&stages)?;
        if broad_phase != BroadPhase::BruteForce {
            self.engine.prepare(MEASURE_ORDER)?;
        }
        if broad_phase == BroadPhase::Grid {
            self.engine.prepare(SORT_MEMORY)?;
        }
        Ok(())
    }
}

#[cfg(all(test, feature = "gpu"))]
mod tests {
    use crate::generate::Benchmark;
    use crate::{Backend, BroadPhase, Integrator, Options, Simulation};

    /// How many kernels there are after preparing, and after steps and sorting besides.
    fn kernels(scene: Benchmark, integrator: Integrator, broad_phase: BroadPhase) -> [usize; 2] {
        let scene = scene.generate(60, 1).unwrap();
        let options = Options::new().backend(Backend::Gpu).integrator(integrator).broad_phase(broad_phase);
        let mut simulation = Simulation::with_options(scene, options).unwrap();
        let compiled = |simulation: &Simulation| simulation.engine.gpu_world().unwrap().gpu().compiled();
        assert_eq!(compiled(&simulation), 0);
        simulation.prepare().unwrap();
        let prepared = compiled(&simulation);
        // The order of memory is looked at, too.
        simulation.run(260, 0.001).unwrap();
        simulation.sort_memory().unwrap();
        [prepared, compiled(&simulation)]
    }

    #[test]
    fn nothing_is_left_to_compile() {
        for (scene, integrator, broad_phase) in [
            (Benchmark::Mixed, Integrator::Rk4, BroadPhase::Grid),
            (Benchmark::Mixed, Integrator::SymplecticEuler, BroadPhase::BruteForce),
            (Benchmark::Thesis, Integrator::Rk4, BroadPhase::SortAndSkip),
        ] {
            let [prepared, used] = kernels(scene, integrator, broad_phase);
            assert!(prepared > 5, "{scene}, {integrator}, {broad_phase}: {prepared}");
            // Sweeps over collisions are prepared, too, and may not be needed.
            assert!(prepared >= used, "{scene}, {integrator}, {broad_phase}: {prepared} {used}");
        }
    }
}
