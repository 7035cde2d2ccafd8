// restore_lengths
