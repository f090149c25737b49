"""The explorer: an interactive page, served on this machine, on which all results follow the inputs.

``inputs``, ``carried`` and ``url`` hold what is asked, ``answer`` asks the package for the answer, ``charts`` and ``table``
show it, ``tab`` and ``page`` tie them together, ``uploads`` and ``downloads`` read and write files, ``server`` runs it behind
``guard``. No equation is solved here.
"""
