"""The explorer: a page on this machine on which a contact is changed by hand and everything else follows.

``inputs`` and ``url`` hold what is asked, ``results`` asks the package for the answer, ``charts`` and ``table`` show it,
``page`` ties them together, ``files`` reads and writes, ``server`` runs it. No equation is solved here.
"""
