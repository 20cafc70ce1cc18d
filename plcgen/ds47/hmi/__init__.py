"""What an HMI shows of drive jobs: texts for status words, error numbers and fault classes, in several languages."""
