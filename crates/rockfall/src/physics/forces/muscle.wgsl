// requires model/objects.wgsl model/step.wgsl physics/product.wgsl

// Rest lengths of muscles (docs/physics section 4.9). Phases are in units of 2^-64 turns.

// Half steps from the base of the clock to the present force evaluation.
fn half_steps() -> u32 {
    return 2u * (step.muscle_step + status.steps) + (evaluation() + 1u) / 2u;
}

// The upper word of the phase of a muscle at the present force evaluation: the phase at the base of the clock, and the change in
// half a step times the half steps since then. `muscle` is the first word of its record, `stride` the distance of its words.
fn muscle_phase(muscle: u32, stride: u32) -> u32 {
    let halves = half_steps();
    let change = topology[muscle + 3u * stride];
    let low = change * halves;
    let carry = u32(low + topology[muscle + stride] < low);
    let high = topology[muscle + 4u * stride] * halves + upper_product(change, halves);
    return topology[muscle + 2u * stride] + high + carry;
}

// Sine of a phase, given by its upper word. It is the sine or cosine of an angle of at most an eighth turn.
fn sine_of_phase(phase: u32) -> f32 {
    let quarter = (phase + 0x20000000u) >> 30u;
    // 2 pi / 2^32.
    let x = f32(bitcast<i32>(phase - (quarter << 30u))) * 1.4629180792671596e-9;
    let xx = x * x;
    let s = x * (1.0 + xx * (-1.0 / 6.0 + xx * (1.0 / 120.0 + xx * (-1.0 / 5040.0 + xx * (1.0 / 362880.0)))));
    let c = 1.0 + xx * (-0.5 + xx * (1.0 / 24.0 + xx * (-1.0 / 720.0 + xx * (1.0 / 40320.0))));
    let value = select(s, c, (quarter & 1u) == 1u);
    return select(value, -value, (quarter & 2u) == 2u);
}

// Rest length of a spring of constant length `length` at the present force evaluation. The amplitude is 0 if it has no muscle.
fn muscle_length(spring: u32, length: f32) -> f32 {
    let muscle = word_of_record(step.muscles_at, spring, MUSCLE_WORDS);
    let phase = muscle_phase(muscle, stride_of(spring_count()));
    return length * fma(float_at(muscle), sine_of_phase(phase), 1.0);
}

fn rest_length(spring: u32, length: f32) -> f32 {
    if MUSCLES {
        return muscle_length(spring, length);
    }
    return length;
}
