// fill_pairs
