/* Scene S1's equation of motion in the crank angle, in closed form: `src/four_bar.rs` in C.

   I(theta) theta'' = Q(theta) - 1/2 I'(theta) theta'^2, k_i = d(theta_i)/d(theta2). SI units, angles in rad. */
#ifndef FOUR_BAR_H
#define FOUR_BAR_H

#include <math.h>

#define SPAN 0.13
#define THETA2 (-1.2377117266891367) /* at the end, from a 34-digit energy quadrature */
static const double START[2] = {0.8, 0.0};

#define GROUND 0.5729
#define CRANK 0.1755
#define COUPLER 0.217
#define FOLLOWER 0.34
#define LEG 0.759
#define CRANK_MASS 13.689
#define COUPLER_MASS 0.72037056
#define FOLLOWER_MASS 3.850704
#define LEG_MASS 36.8
#define WHEEL_MASS 19.5
#define FORCE 30e3
#define PX (-0.050)
#define PY (-0.138)
#define QX (0.020 / FOLLOWER)
#define QY (0.120 / FOLLOWER)
#define COUPLER2 (COUPLER * COUPLER)
#define FOLLOWER2 (FOLLOWER * FOLLOWER)
#define FIXED ((CRANK_MASS / 3 + COUPLER_MASS) * CRANK * CRANK + (LEG_MASS / 3 + WHEEL_MASS) * LEG * LEG)
#define OF_COUPLER (COUPLER_MASS * COUPLER2 / 3)
#define OF_FOLLOWER (FOLLOWER_MASS * FOLLOWER2 / 3)

/* Gravity, and its virtual work on all that turns with the crank, for each of cos and sin of theta2: see `prepare`. */
static double gx, gy, work_cos, work_sin;

/* Work out what does not change; before any use of `acceleration`. */
static void prepare(void)
{
    const double chi = acos(-1.0) / 2 - 1.13, leg = (LEG_MASS / 2 + WHEEL_MASS) * LEG;
    const double along = (CRANK_MASS / 2 + COUPLER_MASS) * CRANK + leg * cos(-2.4), across = leg * sin(-2.4);
    gx = -3 * 9.81 * sin(chi);
    gy = -3 * 9.81 * cos(chi);
    work_cos = along * gy - across * gx;
    work_sin = -(along * gx + across * gy);
}

/* theta2'' for the crank angle and its rate. */
static inline double acceleration(double theta2, double omega)
{
    const double c = cos(theta2), s = sin(theta2), x2 = CRANK * c, y2 = CRANK * s;
    /* C to the left of the diagonal from B to D. */
    const double dx = GROUND - x2, dy = -y2, inverse = 1 / (dx * dx + dy * dy);
    const double along = 0.5 + 0.5 * (COUPLER2 - FOLLOWER2) * inverse;
    const double across = sqrt(COUPLER2 * inverse - along * along);
    const double x3 = along * dx - across * dy, y3 = along * dy + across * dx, x4 = x3 - dx, y4 = y3 - dy;

    const double c34 = 1 / (x3 * y4 - y3 * x4), c23 = x2 * y3 - y2 * x3;
    const double d34 = x3 * x4 + y3 * y4, d23 = x2 * x3 + y2 * y3, d24 = x2 * x4 + y2 * y4;
    const double k3 = (y2 * x4 - x2 * y4) * c34, k4 = -c23 * c34;
    const double k3_slope = (d24 + k3 * k3 * d34 - k4 * k4 * FOLLOWER2) * c34;
    const double k4_slope = (d23 + k3 * k3 * COUPLER2 - k4 * k4 * d34) * c34;

    const double inertia = FIXED + OF_FOLLOWER * k4 * k4 + k3 * (OF_COUPLER * k3 + COUPLER_MASS * d23);
    const double half_slope = OF_FOLLOWER * k4 * k4_slope + OF_COUPLER * k3 * k3_slope
                              + 0.5 * COUPLER_MASS * (k3_slope * d23 + k3 * (1 - k3) * c23);

    const double px = PX * c - PY * s, py = PX * s + PY * c, qx = QX * x4 - QY * y4, qy = QX * y4 + QY * x4;
    const double sx = GROUND + qx - px, sy = qy - py;
    const double push = FORCE * (k4 * (qx * sy - qy * sx) - (px * sy - py * sx)) / sqrt(sx * sx + sy * sy);
    const double weight = work_cos * c + work_sin * s
                          + 0.5 * (COUPLER_MASS * k3 * (x3 * gy - y3 * gx) + FOLLOWER_MASS * k4 * (x4 * gy - y4 * gx));
    return (push + weight - half_slope * omega * omega) / inertia;
}

#endif
