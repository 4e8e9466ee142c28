"""Plant models. Laws that other packages compile are plain functions of floats."""
