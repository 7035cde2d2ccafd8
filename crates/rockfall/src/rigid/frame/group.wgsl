// requires

// The stages of one workgroup, for small scenes and for impacts. They call the same functions in the same order as the dispatches, so
// the results are the same for any number of threads.

override GROUP: u32 = 256u;
