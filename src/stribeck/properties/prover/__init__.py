"""Proofs that an expression of u = |v| and w = |z| has a sign over a whole region, with the certificate of each."""
