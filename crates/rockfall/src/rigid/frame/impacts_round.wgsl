// requires rigid/frame/known.wgsl rigid/frame/impacts.wgsl

// The impacts of blocks with round pairs: the stages of all others, with what `find.wgsl` has found.
