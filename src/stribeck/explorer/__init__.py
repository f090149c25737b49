"""The explorer: a page on this machine on which a contact is changed by hand and everything else follows.

``inputs``, ``carried`` and ``url`` hold what is asked, ``answer`` asks the package for the answer, ``charts`` and ``table``
show it, ``tab`` and ``page`` tie them together, ``reading`` and ``downloads`` read and write files, ``server`` runs it behind
``serving.guard``. No equation is solved here.
"""
