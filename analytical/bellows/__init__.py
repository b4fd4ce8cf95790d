"""The closed form of a bellows actuator with rigid crest rings: Heung et al., Biomimetics 2024, 9, 160.

dimensions  : of a bellows, one or many at once
chains      : the closed-form model as printed, with its misprints corrected, with its statics corrected too
reading     : how the equations are read, item by item
equations   : the equations themselves, element by element
corrections : every departure from the print, and what it is worth
loads       : pressure for an elongation, force at a held tip
validity    : the chain with one assumption replaced: root, side wall, tip
paper       : what the paper prints, and the dimensions inferred from it
fit/        : all dimensions that meet the printed closed form, and the rule that picks three sets of them
"""
