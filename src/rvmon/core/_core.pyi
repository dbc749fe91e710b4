source_hash: str
