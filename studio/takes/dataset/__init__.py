"""Takes to pairs, data set versions, a map and a score."""
