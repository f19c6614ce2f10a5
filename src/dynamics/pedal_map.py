# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
"""From pedals to accelerations and back for the vehicle's default options; e2e_cdiff/dynamics/pedal_map.h is the same in C++.

    from e2e_cdiff.pedal_map import acceleration_of, pedals_for, steer_for
    throttle, brake = pedals_for(speed=6.0, acceleration=-1.5)      # m/s, m/s^2
"""
import math

TICK = 0.05  # s
STEERING_GAIN = 0.36848336  # wheel angle at steer = 1 [rad]
REAR_LENGTH = 1.4178275  # center to rear axle [m]
WHEELBASE = REAR_LENGTH - 0.090769015  # [m]
MAX_DECELERATION = 8.0  # m/s^2
MAX_SPEED = 40.0  # m/s
LEAST_THROTTLE = 0.3  # what the fit responds to
_BRAKE_FIT = (-4.91381935e-12, 2.44419284e-9, -4.90357228e-7, 5.06587474e-5, -2.83832427e-3, 8.20967431e-2, 9.31711370e-3)
_STEPS, _HALVINGS = 70, 40


def _driven(v, u):
    """Speed a tick after v under throttle u [km/h]."""
    return (0.963873001 * v + 4.37535692e-4 * v * v - 0.380192912 * u + 1.74950069 * u * u + 0.0916787414 * v * u - 0.0705461530 * v * u * u
            - 1.05996152e-3 * v * v * u + 6.71079346e-4 * v * v * u * u)


def _braked(v):
    value = 0.0
    for coefficient in _BRAKE_FIT:
        value = (value + coefficient) * v
    return value


def next_speed(speed, throttle, brake):
    """Speed [m/s] 0.05 s after `speed` [m/s]."""
    v = 3.6 * speed
    drive = 0.0 if throttle < LEAST_THROTTLE else _driven(v, throttle) - v
    full = min(max(_braked(v) - v, -MAX_DECELERATION * TICK * 3.6), 0.0)
    change = (1.0 - brake) * drive + brake * full
    following = min(max((v + change) / 3.6, 0.0), MAX_SPEED)
    return 0.0 if brake > 0.0 and change <= 0.0 and following < 1e-3 else following


def acceleration_of(speed, throttle, brake=0.0):
    """Acceleration [m/s^2] of the pedals at `speed` [m/s]."""
    return (next_speed(speed, throttle, brake) - speed) / TICK


def _throttle_for(speed, acceleration):
    least = acceleration_of(speed, LEAST_THROTTLE)
    if acceleration <= 0.5 * least or acceleration == 0.0:
        return 0.0
    best, most = LEAST_THROTTLE, least
    for step in range(_STEPS + 1):
        throttle = LEAST_THROTTLE + (1.0 - LEAST_THROTTLE) * step / _STEPS
        reached = acceleration_of(speed, throttle)
        if reached >= acceleration:
            low, high = LEAST_THROTTLE + (1.0 - LEAST_THROTTLE) * (step - 1) / _STEPS, throttle
            for _ in range(_HALVINGS if step > 0 else 0):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if acceleration_of(speed, middle) < acceleration else (low, middle)
            return high
        if reached > most:
            best, most = throttle, reached
    return best if most > 0.0 else 0.0


def pedals_for(speed, acceleration):
    """(throttle, brake), one of them 0, nearest to `acceleration` [m/s^2] at `speed` [m/s]. Raises ValueError for what is not finite."""
    if not (math.isfinite(speed) and speed >= 0.0 and math.isfinite(acceleration)):
        raise ValueError(f"speed {speed} m/s, acceleration {acceleration} m/s^2; expected finite numbers and no negative speed")
    if acceleration >= 0.0:
        return _throttle_for(speed, acceleration), 0.0
    full = acceleration_of(speed, 0.0, 1.0)
    return 0.0, min(1.0, acceleration / full) if full < 0.0 else 1.0


def steer_for(curvature):
    """Steer in [-1, 1] for a curvature [1/m] of the path, positive left. Raises ValueError beyond the vehicle's."""
    largest = math.sin(math.atan(REAR_LENGTH / WHEELBASE * math.tan(STEERING_GAIN))) / REAR_LENGTH
    if not abs(curvature) <= largest + 1e-9:
        raise ValueError(f"curvature {curvature} 1/m; the vehicle's largest is {largest:.6f} 1/m")
    slip = math.asin(min(max(curvature, -largest), largest) * REAR_LENGTH)
    return min(max(math.atan(math.tan(slip) * WHEELBASE / REAR_LENGTH) / STEERING_GAIN, -1.0), 1.0)
