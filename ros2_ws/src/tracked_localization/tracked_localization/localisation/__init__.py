"""Where the robot is on a known map."""
