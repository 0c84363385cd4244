//! A page to turn the fabric in the hand.
