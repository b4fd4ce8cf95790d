"""Material laws and their constants; the only part of ``analytical`` that solvers know.

isotropic : neo-Hooke, Yeoh, Ogden (with its two conventions) and an exponential law, what a law has to offer
numerical : any other energy, with derivatives taken numerically
stability : up to which stretch a law can be used
silicones : constants of Dragon Skin 10 and 30
stiff     : linear elastic solids of the rings, with the constants of PLA and polyethylene
errors    : what is refused

Every law states its initial shear modulus. Ogden's constants mean nothing without their convention, so it is always
named: "2mu/alpha^2" or "mu/alpha".
"""
