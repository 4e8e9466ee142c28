"""Pictures of runs as inline SVG: one module per picture, one style for all."""
