"""What is told about the service: one module per subject, its models and what fills them."""
