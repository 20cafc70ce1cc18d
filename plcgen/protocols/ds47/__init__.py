"""PROFIdrive, data set 47: parameter jobs on drives."""
