"""What a fit may model beside tyre and rig, chosen by prediction: temperature, hysteresis, lag, wear, scatter from run to run."""
