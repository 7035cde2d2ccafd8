// advance
