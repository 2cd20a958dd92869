"""The support bundle: everything that somebody needs who is to help, in one file, without secrets.

bundle       which files there are, and what is in each
versions     of everything that the service runs on
redaction    takes out secrets and contacts
"""
