"""What the topic-level tests share: a domain, a probe node, processes."""
