"""What the user describes: site files, maps, built-in sites."""
