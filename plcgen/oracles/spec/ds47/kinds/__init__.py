"""One file for each kind of job: what a job of it demands of its drive."""
