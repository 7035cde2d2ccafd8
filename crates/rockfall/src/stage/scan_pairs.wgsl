// scan_pairs
