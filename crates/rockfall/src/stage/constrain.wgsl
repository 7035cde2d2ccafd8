// constrain
