"""What moves around the robot: seen where the map says there is nothing, followed, and predicted."""
