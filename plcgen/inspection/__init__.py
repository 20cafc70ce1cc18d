"""What reviewers ask: layouts, differences, locks, audits."""
