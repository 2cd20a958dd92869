"""``pslv play``: programs play against each other in a simulated venue, each seeing nothing but its robot's views.

A controller is a class: it is made with its ``Robot`` and turns each ``View`` into a ``Drive``. ``players`` gives every
robot a thread with a connection of its own; a thread takes the newest view, asks the controller and sends the command.
``game`` reads the score that the service counts from its simulation, ``match`` plays and collects, ``chart`` draws.

Files, from the top down: ``match``, ``players``, ``game``, ``controllers`` (loads one by its name), ``chart``.
"""
