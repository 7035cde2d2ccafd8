// objects
