// pair_tiles
