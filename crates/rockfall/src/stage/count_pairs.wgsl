// count_pairs
