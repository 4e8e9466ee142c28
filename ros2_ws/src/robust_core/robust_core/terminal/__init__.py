"""Terminal weights and sets of predictive controllers, with proofs that the cost descends."""
