//! Compiles kernels before they are needed.

use crate::error::Result;
use crate::settings::BroadPhase;
use crate::simulation::Simulation;
#[cfg(not(target_family = "wasm"))]
use crate::simulation::engine;
use crate::step::schedule::{MEASURE_ORDER, Run, SORT_MEMORY};

impl Simulation {
    /// Compiles all kernels that steps of the current scene need. Otherwise a kernel is compiled before it runs for the first
    /// time; those that sort memory are then compiled in the middle of a run.
    ///
    /// This takes some tenths of a second, and longer if the device's driver has not seen the kernels before. On the CPU it
    /// does nothing. Objects of kinds that the scene did not contain may need other kernels.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when a kernel does not compile or the device is lost.
    #[cfg(not(target_family = "wasm"))]
    pub fn prepare(&mut self) -> Result<()> {
        let device = self.engine.waiter();
        engine::block_on(device, self.prepare_async())
    }

    /// [`Simulation::prepare`] without waiting for the device. Compiling still blocks the calling thread.
    ///
    /// # Errors
    /// As for [`Simulation::prepare`].
    pub async fn prepare_async(&mut self) -> Result<()> {
        self.flush_async().await?;
        let (integrator, broad_phase) = (self.integrator(), self.broad_phase_method());
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

    /// Number of kernels after preparing, and after steps and sorting.
    fn kernels(scene: Benchmark, integrator: Integrator, broad_phase: BroadPhase) -> [usize; 2] {
        let scene = scene.generate(60, 1).unwrap();
        let options = Options::new().backend(Backend::Gpu).integrator(integrator).broad_phase(broad_phase);
        let mut simulation = Simulation::with_options(scene, options).unwrap();
        let compiled = |simulation: &Simulation| simulation.engine.gpu_world().unwrap().gpu().compiled();
        assert_eq!(compiled(&simulation), 0);
        simulation.prepare().unwrap();
        let prepared = compiled(&simulation);
        // After 256 steps the order of memory is measured, which needs a kernel too.
        simulation.run(260, 0.001).unwrap();
        simulation.sort_memory().unwrap();
        [prepared, compiled(&simulation)]
    }

    #[test]
    fn prepare_compiles_all_kernels_on_the_gpu() {
        for (scene, integrator, broad_phase) in [
            (Benchmark::Mixed, Integrator::Rk4, BroadPhase::Grid),
            (Benchmark::Mixed, Integrator::SymplecticEuler, BroadPhase::BruteForce),
            (Benchmark::Thesis, Integrator::Rk4, BroadPhase::SortAndSkip),
        ] {
            let [prepared, used] = kernels(scene, integrator, broad_phase);
            assert!(prepared > 5, "{scene}, {integrator}, {broad_phase}: {prepared}");
            // Sweeps over collisions are prepared too, but may not be needed.
            assert!(prepared >= used, "{scene}, {integrator}, {broad_phase}: {prepared} {used}");
        }
    }
}
