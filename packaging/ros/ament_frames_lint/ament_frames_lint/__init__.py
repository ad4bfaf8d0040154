"""Coordinate frames of a ROS package, checked by frames-lint."""
