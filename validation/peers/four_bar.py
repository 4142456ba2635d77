"""Scene S1's equation of motion in the crank angle, in closed form: `src/four_bar.rs` in plain Python.

I(theta) theta'' = Q(theta) - 1/2 I'(theta) theta'^2, k_i = d(theta_i)/d(theta2). The function uses numbers only: numba
can compile it.
"""

from __future__ import annotations

from math import cos, pi, sin, sqrt

START = (0.8, 0.0)
"""theta2 [rad] and its rate [rad/s]."""
SPAN = 0.13
"""Length of the run [s]."""
EXACT = -1.2377117266891367
"""theta2 at the end, from an energy quadrature with 34 digits [rad]."""

GROUND, CRANK, COUPLER, FOLLOWER, LEG = 0.5729, 0.1755, 0.217, 0.34, 0.759
CRANK_MASS, COUPLER_MASS, FOLLOWER_MASS, LEG_MASS, WHEEL_MASS = 13.689, 0.72037056, 3.850704, 36.8, 19.5
CHI = pi / 2 - 1.13
GX, GY = -3 * 9.81 * sin(CHI), -3 * 9.81 * cos(CHI)
FORCE, PX, PY, QX, QY = 30e3, -0.050, -0.138, 0.020 / FOLLOWER, 0.120 / FOLLOWER
FIXED = (CRANK_MASS / 3 + COUPLER_MASS) * CRANK**2 + (LEG_MASS / 3 + WHEEL_MASS) * LEG**2
OF_COUPLER, OF_FOLLOWER = COUPLER_MASS * COUPLER**2 / 3, FOLLOWER_MASS * FOLLOWER**2 / 3
ALONG_CRANK = (CRANK_MASS / 2 + COUPLER_MASS) * CRANK + (LEG_MASS / 2 + WHEEL_MASS) * LEG * cos(-2.4)
ACROSS_CRANK = (LEG_MASS / 2 + WHEEL_MASS) * LEG * sin(-2.4)
WORK_COS = ALONG_CRANK * GY - ACROSS_CRANK * GX
WORK_SIN = -(ALONG_CRANK * GX + ACROSS_CRANK * GY)
COUPLER2, FOLLOWER2, HALF_DIFFERENCE = COUPLER**2, FOLLOWER**2, 0.5 * (COUPLER**2 - FOLLOWER**2)


def acceleration(theta2: float, omega: float) -> float:
    """theta2'' [rad/s2] for the crank angle [rad] and its rate [rad/s]."""
    c, s = cos(theta2), sin(theta2)
    x2, y2 = CRANK * c, CRANK * s
    # C lies to the left of the diagonal from B to D.
    dx, dy = GROUND - x2, -y2
    inverse = 1 / (dx * dx + dy * dy)
    along = 0.5 + HALF_DIFFERENCE * inverse
    across = sqrt(COUPLER2 * inverse - along * along)
    x3, y3 = along * dx - across * dy, along * dy + across * dx
    x4, y4 = x3 - dx, y3 - dy

    c34, c23 = 1 / (x3 * y4 - y3 * x4), x2 * y3 - y2 * x3
    d34, d23, d24 = x3 * x4 + y3 * y4, x2 * x3 + y2 * y3, x2 * x4 + y2 * y4
    k3, k4 = (y2 * x4 - x2 * y4) * c34, -c23 * c34
    k3_slope = (d24 + k3 * k3 * d34 - k4 * k4 * FOLLOWER2) * c34
    k4_slope = (d23 + k3 * k3 * COUPLER2 - k4 * k4 * d34) * c34

    inertia = FIXED + OF_FOLLOWER * k4 * k4 + k3 * (OF_COUPLER * k3 + COUPLER_MASS * d23)
    half_slope = (
        OF_FOLLOWER * k4 * k4_slope
        + OF_COUPLER * k3 * k3_slope
        + 0.5 * COUPLER_MASS * (k3_slope * d23 + k3 * (1 - k3) * c23)
    )

    px, py = PX * c - PY * s, PX * s + PY * c
    qx, qy = QX * x4 - QY * y4, QX * y4 + QY * x4
    sx, sy = GROUND + qx - px, qy - py
    push = FORCE * (k4 * (qx * sy - qy * sx) - (px * sy - py * sx)) / sqrt(sx * sx + sy * sy)
    weight = (
        WORK_COS * c
        + WORK_SIN * s
        + 0.5 * (COUPLER_MASS * k3 * (x3 * GY - y3 * GX) + FOLLOWER_MASS * k4 * (x4 * GY - y4 * GX))
    )
    return (push + weight - half_slope * omega * omega) / inertia
