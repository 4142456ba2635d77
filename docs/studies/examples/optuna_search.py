"""Optuna: masses of leg and wheel against the retraction time, two objectives. usage: optuna_search.py FMU [TRIALS]"""

from __future__ import annotations

import sys

import optuna
from gear import Gear

gear = Gear(sys.argv[1])


def objectives(trial: optuna.Trial) -> tuple[float, float]:
    """Retraction time [s], to be small, and the mass that is carried [kg], to be large."""
    leg = trial.suggest_float("leg.mass", 20.0, 60.0)
    wheel = trial.suggest_float("wheel.mass", 10.0, 30.0)
    time = gear.retraction(leg__mass=leg, wheel__mass=wheel)
    if time < 0.0:
        raise optuna.TrialPruned
    return time, leg + wheel


optuna.logging.set_verbosity(optuna.logging.WARNING)
study = optuna.create_study(directions=["minimize", "maximize"], sampler=optuna.samplers.NSGAIISampler(seed=1))
study.optimize(objectives, n_trials=int(sys.argv[2]) if len(sys.argv) > 2 else 500)
gear.close()
for trial in sorted(study.best_trials, key=lambda trial: trial.values[0]):
    time, mass = trial.values
    print(f"{mass:.2f} kg in {time:.6f} s: {trial.params}")
