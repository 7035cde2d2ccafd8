//! The GPU of each process.

use crate::options::{Backend, Options};
use crate::{DeviceInfo, devices};

/// Options for process `rank` of those that share a simulation: if no GPU is given, process r takes number r modulo n of the n GPUs of its
/// host that are equal to the best one. Others would compute other bits.
pub fn with_device(options: Options, rank: usize) -> Options {
    if options.backend == Backend::Cpu || options.device.is_some() {
        return options;
    }
    let devices = devices();
    let Some(best) = devices.first() else { return options };
    let is_equal = |device: &DeviceInfo| device.name == best.name && device.backend == best.backend;
    let numbers: Vec<usize> = (0..devices.len()).filter(|number| is_equal(&devices[*number])).collect();
    // A device that a CPU emulates is used only on request.
    let is_wanted = !best.software || options.backend == Backend::Gpu;
    if is_wanted { options.device(numbers[rank % numbers.len()]) } else { options }
}
